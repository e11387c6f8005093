#include "corda/golden/update_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <utility>

#include "corda/core/output_file.hpp"

namespace corda::golden {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolder = "/.corda-golden-update";
constexpr const char* kMarker = "/corda-golden-update";
constexpr const char* kJournal = "/journal";
constexpr const char* kUndo = "/undo";
/// The last entry of a journal, without which it breaks off.
constexpr std::string_view kEndOfJournal{"end\0", 4};

/// The status of a name itself; symbolic links are not followed.
fs::file_type type_of(const std::string& path) {
    std::error_code none;
    return fs::symlink_status(path, none).type();
}

bool exists(const std::string& path) {
    const fs::file_type type = type_of(path);
    return type != fs::file_type::not_found && type != fs::file_type::none;  // none: it cannot be looked up
}

std::string bytes_of(const std::string& path) {
    std::string text(file_size(path), '\0');
    if (read_bytes(open_for_reading(path), path, text.data(), text.size()) < text.size())
        fail_file("read", path, EIO);
    return text;
}

void rename_or_fail(const std::string& from, const std::string& to, const std::string& told) {
    if (std::rename(from.c_str(), to.c_str()) != 0) fail_file("replace", told, errno);
}

void make_private_folder(const std::string& path) {
    if (::mkdir(path.c_str(), 0700) != 0) fail_file("make the folder", path, errno);
}

[[noreturn]] void fail_at_work(const std::string& pictures) {
    throw Error(ExitCode::kTemporary,
                fmt::format("another update is writing to '{}'; try again when it has ended", pictures));
}

/// True for a folder that an update made, or has just begun to make.
bool is_ours(const std::string& inside) {
    std::error_code none;
    return type_of(inside + kMarker) == fs::file_type::regular || fs::is_empty(inside, none);
}

}  // namespace

UpdateFolder::UpdateFolder(std::string pictures, std::string inside, Descriptor lock)
    : pictures_(std::move(pictures)), inside_(std::move(inside)), lock_(std::move(lock)) {}

std::optional<UpdateFolder> UpdateFolder::open(const std::string& pictures) {
    std::string inside = pictures + kFolder;
    Descriptor folder(::open(inside.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (!folder && errno == ENOENT) return std::nullopt;
    if (!folder && errno != ENOTDIR && errno != ELOOP) fail_file("open", inside, errno);
    // Every failure but EWOULDBLOCK means a file system without locks.
    if (folder && ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        fail_at_work(pictures);
    if (folder && !leads_to(inside, folder)) return std::nullopt;
    if (!folder || !is_ours(inside))
        throw Error(ExitCode::kIo, fmt::format("'{}' was not made by corda, and an update needs this name; "
                                               "move it away",
                                               inside));
    return UpdateFolder(pictures, std::move(inside), std::move(folder));
}

UpdateFolder UpdateFolder::create(const std::string& pictures) {
    const std::string inside = pictures + kFolder;
    constexpr int kMaxAttempts = 100;
    for (int i = 0; i < kMaxAttempts; ++i) {
        const bool is_new = ::mkdir(inside.c_str(), 0700) == 0;
        if (!is_new && errno != EEXIST) fail_file("make the folder", inside, errno);
        std::optional<UpdateFolder> made = open(pictures);
        if (!made) continue;  // another process took the new folder for a leftover
        if (made->has_journal()) static_cast<void>(made->settle());
        if (!is_new) {
            made->remove();
            if (exists(inside)) fail_file("remove", inside, ENOTEMPTY);
            continue;
        }
        const Descriptor marker = create_new(inside + kMarker, 0600);
        if (!marker) fail_file("write", inside + kMarker, errno);
        make_private_folder(inside + "/new");
        make_private_folder(inside + "/old");
        return std::move(*made);
    }
    fail_at_work(pictures);
}

bool UpdateFolder::has_journal() const {
    return exists(inside_ + kJournal) || exists(inside_ + kUndo);
}

void UpdateFolder::publish(const std::vector<std::string>& written, const std::vector<std::string>& removed) {
    const Saving saving;
    std::string text;  // each entry ends with a zero byte, which no file name contains
    for (const std::string& name : written) text += (exists(picture(name)) ? "w" : "a") + name + '\0';
    for (const std::string& name : removed) text += "r" + name + '\0';
    text += kEndOfJournal;
    OutputFile journal(inside_ + kJournal);
    journal.write(text);
    sync_folder_of(inside_);
    journal.commit();
    try {
        apply(read_journal(kJournal));
    } catch (const Error& error) {
        std::string outcome = "no picture was changed";
        try {
            take_back(read_journal(kJournal));
        } catch (const Error& second) {
            outcome = fmt::format(
                "and some pictures are new ({}); the next corda golden with this folder "
                "takes them back",
                second.what());
        }
        throw Error(error.code(), fmt::format("{}; {}", error.what(), outcome));
    }
}

std::string UpdateFolder::settle() {
    const Saving saving;
    if (exists(inside_ + kJournal)) {
        const std::vector<Change> changes = read_journal(kJournal);
        if (is_restored(changes)) {
            take_back(changes);
            return fmt::format(
                "took back an interrupted update of '{}', some of whose pictures were restored since",
                pictures_);
        }
        try {
            apply(changes);
            return fmt::format("completed an interrupted update of '{}': {} pictures", pictures_,
                               changes.size());
        } catch (const Error& error) {
            take_back(changes);
            return fmt::format(
                "took back an interrupted update of '{}', because it could not be completed: "
                "{}",
                pictures_, error.what());
        }
    }
    take_back(read_journal(kUndo));
    return fmt::format("took back a failed update of '{}'", pictures_);
}

void UpdateFolder::remove() noexcept {
    if (has_journal()) return;
    std::error_code ignored;
    // The marker goes last: until then a process that finds the folder recognises it.
    for (const char* const name : {"/new", "/old"}) fs::remove_all(inside_ + name, ignored);
    for (const fs::directory_entry& entry : fs::directory_iterator(inside_, ignored))
        if (entry.path().string() != inside_ + kMarker) fs::remove_all(entry.path(), ignored);
    fs::remove_all(inside_, ignored);
}

std::vector<UpdateFolder::Change> UpdateFolder::read_journal(const std::string& name) const {
    const std::string path = inside_ + name;
    std::string text = bytes_of(path);
    // A link here would make the renames move files of other folders.
    for (const char* const folder : {"/new", "/old"})
        if (type_of(inside_ + folder) != fs::file_type::directory)
            fail_file("read", inside_ + folder, ENOTDIR);
    const auto require = [&](bool is_valid) {
        if (is_valid) return;
        throw Error(
            ExitCode::kIo,
            fmt::format("'{}' is damaged; restore the pictures of '{}' (git checkout), and remove '{}'", path,
                        pictures_, inside_));
    };
    require(text == kEndOfJournal || text.ends_with('\0' + std::string(kEndOfJournal)));
    text.resize(text.size() - kEndOfJournal.size());
    std::vector<Change> changes;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\0', begin), text.size());
        std::string entry = text.substr(begin, end - begin);
        begin = end + 1;
        require(entry.size() > 1 && (entry[0] == 'w' || entry[0] == 'a' || entry[0] == 'r') &&
                entry.find('/') == std::string::npos && entry.substr(1) != "." && entry.substr(1) != "..");
        changes.push_back({.kind = entry[0], .name = entry.substr(1)});
    }
    return changes;
}

/// Whether the user has put a replaced picture back, as `git checkout` does.
bool UpdateFolder::is_restored(const std::vector<Change>& changes) const {
    return std::any_of(changes.begin(), changes.end(), [this](const Change& change) {
        return change.kind == 'w' && !exists(staged(change.name)) && exists(old(change.name)) &&
               type_of(picture(change.name)) == fs::file_type::regular &&
               bytes_of(picture(change.name)) == bytes_of(old(change.name));
    });
}

void UpdateFolder::save_old(const Change& change) const {
    const bool is_removal = change.kind == 'r';
    const std::string& name = change.name;
    const std::string path = picture(name);
    if (exists(old(name)) && !is_removal) return;
    if (!exists(path)) return;
    if (type_of(path) == fs::file_type::directory) fail_file("replace", path, EISDIR);
    // A second name leaves the picture in place until the new one replaces it, where links exist.
    if (!is_removal && ::link(path.c_str(), old(name).c_str()) == 0) return;
    if (std::rename(path.c_str(), old(name).c_str()) != 0)
        fail_file(is_removal ? "remove" : "replace", path, errno);
}

void UpdateFolder::apply(const std::vector<Change>& changes) const {
    for (const Change& change : changes) {
        const bool is_removal = change.kind == 'r';
        if (!is_removal && !exists(staged(change.name))) continue;  // it is published
        save_old(change);
        if (!is_removal) rename_or_fail(staged(change.name), picture(change.name), picture(change.name));
    }
    sync_folder_of(picture("any"));
    if (::unlink((inside_ + kJournal).c_str()) != 0) fail_file("remove", inside_ + kJournal, errno);
}

void UpdateFolder::take_back(const std::vector<Change>& changes) const {
    if (exists(inside_ + kJournal)) {
        rename_or_fail(inside_ + kJournal, inside_ + kUndo, inside_ + kUndo);
        sync_folder_of(inside_ + kUndo);
    }
    for (const Change& change : changes) {
        const std::string path = picture(change.name);
        if (exists(old(change.name)))
            rename_or_fail(old(change.name), path, path);
        else if (change.kind == 'a' && !exists(staged(change.name)) && exists(path))
            rename_or_fail(path, staged(change.name), path);
    }
    sync_folder_of(picture("any"));
    if (::unlink((inside_ + kUndo).c_str()) != 0) fail_file("remove", inside_ + kUndo, errno);
}

std::string settle_update(const std::string& pictures, bool dry_run) {
    const std::string inside = pictures + kFolder;
    const bool has_changes = exists(inside + kJournal) || exists(inside + kUndo);
    if (has_changes && dry_run)
        throw Error(ExitCode::kIo, fmt::format("an update of '{}' was interrupted; run corda golden without "
                                               "--dry-run first, which completes it or takes it back",
                                               pictures));
    if (!has_changes)
        return "";  // staged pictures without a journal have changed nothing; an update removes them
    std::optional<UpdateFolder> left = UpdateFolder::open(pictures);
    if (!left || !left->has_journal()) return "";
    std::string done = left->settle();
    left->remove();
    return done;
}

}  // namespace corda::golden
