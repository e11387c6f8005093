# Reads all paths of the repository, then the headings of its pages, then the text of all files, and prints each citation
# that does not resolve; see citations.sh.

# The anchor that GitHub gives a heading.
function slug(heading) {
    heading = tolower(heading)
    gsub(/[^a-z0-9 _-]/, "", heading)
    gsub(/ /, "-", heading)
    return heading
}

function complain(citation, why) {
    print file ": \"" citation "\" " why
    failures++
}

# True if a path is in the repository: from its root, or, unless `exact`, as the end of a path. "*" matches anything.
function is_there(path, exact,    k) {
    sub(/^corda\//, "", path)
    sub(/\/$/, "", path)
    if (path in paths || (!exact && path in ends)) return 1
    if (path !~ /\*/) return 0
    sub(/\*.*/, "", path)
    for (k in paths) {
        if (index(k, path) == 1 || (!exact && index(k, "/" path) > 0)) return 1
    }
    return 0
}

function check_reference(citation) {
    sub(/^[^R]/, "", citation)
    if (!(citation in references)) complain(citation, "is not a heading of src/corda/sim/README.md")
}

# "section 5 of src/corda/sim/README.md", "sections 1 and 4 of ...", or "section 5" within a page. Sections of something else
# ("RFC 4180 section 2", "section 2 of the book") are taken for sections of a publication.
function check_section(citation,    page, numbers, count, k) {
    if (citation ~ /^[^ ]*[0-9][^ ]* /) return
    sub(/^.*[Ss]ections? /, "", citation)
    citation = "section " citation
    page = citation
    if (!sub(/.* of \[?/, "", page)) {
        page = file
        if (file !~ /\.md$/) return complain(citation, "does not name the page: add \"of src/.../README.md\"")
    } else if (!sub(/\.md.*/, ".md", page)) {
        return
    }
    count = split(citation, numbers, /[^0-9.]+/)
    for (k = 1; k <= count; ++k) {
        sub(/\.$/, "", numbers[k])
        if (numbers[k] ~ /^[0-9]/ && !((page, numbers[k]) in sections)) complain(citation, "is not a heading of " page)
    }
}

function check_path(citation) {
    sub(/^[^a-z]/, "", citation)
    sub(/[.,*-]+$/, "", citation)
    if (!is_there(citation, 1)) complain(citation, "is not in the repository")
}

function check_name(citation) {
    sub(/^[^A-Za-z0-9_]/, "", citation)
    if (!is_there(citation, 0)) complain(citation, "is no file of the repository")
}

# The target of a link in a page, relative to the page.
function check_link(citation,    path, anchor) {
    path = substr(citation, 3, length(citation) - 3)
    if (path ~ /^[a-z]+:/) return
    anchor = path
    if (!sub(/^[^#]*#/, "", anchor)) anchor = ""
    sub(/#.*/, "", path)
    if (path == "") {
        path = file
    } else {
        path = folder path
        while (sub(/[^\/]+\/\.\.\//, "", path)) continue
        if (!is_there(path, 1)) return complain(citation, "is not in the repository")
    }
    if (anchor != "" && !((path, anchor) in anchors)) complain(citation, "has no such heading")
}

# An identifier of the code, e.g. "`Rattle::step_s()`", in a page for developers. Its last part must occur in a source,
# which may be read later.
function check_identifier(citation) {
    gsub(/`/, "", citation)
    sub(/(\(\)|\[[^]]*\])$/, "", citation)
    if (citation !~ /^([A-Za-z_][A-Za-z0-9_]*::)*[A-Za-z_][A-Za-z0-9_]*$/) return
    identifiers[file, citation] = file
}

function check_identifiers(    key, citation, name) {
    for (key in identifiers) {
        file = identifiers[key]
        citation = substr(key, length(file SUBSEP) + 1)
        name = citation
        sub(/^.*::/, "", name)
        if (!(name in words)) complain(citation, "is in no source")
    }
}

function check_outside(citation) {
    complain(citation, "cites a page that is not in the repository")
}

function check(kind, citation) {
    if (kind == "reference") check_reference(citation)
    if (kind == "section") check_section(citation)
    if (kind == "path") check_path(citation)
    if (kind == "name") check_name(citation)
    if (kind == "link") check_link(citation)
    if (kind == "outside") check_outside(citation)
    if (kind == "identifier") check_identifier(citation)
}

# Checks all matches of `pattern` that no letter or digit follows.
function check_all(kind, pattern,    rest, citation) {
    rest = text
    while (match(rest, pattern)) {
        citation = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        if (rest !~ /^[A-Za-z0-9_]/) check(kind, citation)
    }
}

function finish_file() {
    if (text == "") return
    folder = file
    if (!sub(/[^\/]*$/, "", folder)) folder = ""
    check_all("reference", "[^A-Za-z0-9_]R[0-9]+")
    check_all("section", "([^ ]+ )?[Ss]ections? [0-9]+(\\.[0-9]+)*((,| and| to) [0-9]+(\\.[0-9]+)*)*( of \\[?[^ ]+)?")
    check_all("path", "[^A-Za-z0-9_./}-](src|tests|examples|shaders)/[A-Za-z0-9_./*-]+")
    check_all("name", "[^A-Za-z0-9_.*/$}>-][A-Za-z0-9_/]*[a-z0-9_]\\.(hpp|cpp|frag|vert)")
    check_all("outside", "(PHYSICS|DESIGN|SCENE|VIDEO)(\\.md| section| R[0-9]+)")
    if (file ~ /\.md$/) check_all("link", "\\]\\([^) ]+\\)")
    if (file ~ /^src\/.*\.md$/) check_all("identifier", "`[^`]+`")
    text = ""
}

part == "" {
    paths[$0] = 1
    for (end = $0; sub(/^[^\/]*\//, "", end);) ends[end] = 1
    next
}

part == "headings" {
    if ($0 !~ /^#+ /) next
    sub(/^#+ +/, "")
    anchors[FILENAME, slug($0)] = 1
    if (match($0, /^[0-9]+(\.[0-9]+)*/)) sections[FILENAME, substr($0, 1, RLENGTH)] = 1
    if (FILENAME == "src/corda/sim/README.md" && match($0, /^R[0-9]+/)) references[substr($0, 1, RLENGTH)] = 1
    next
}

FNR == 1 {
    finish_file()
    file = FILENAME
}

/^[ \t]*#include/ { next }

FILENAME ~ /\.(hpp|cpp|frag|vert)$/ {
    count = split($0, names, /[^A-Za-z0-9_]+/)
    for (k = 1; k <= count; ++k) words[names[k]] = 1
}

{
    sub(/^[ \t]*(\/\/\/?<?|#+|\*)[ \t]*/, "")  # a sentence may continue in the comment of the next line
    text = text " " $0
}

END {
    finish_file()
    check_identifiers()
    exit failures > 0
}
