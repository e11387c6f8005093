# For scripts that need a new Debian system: source it. They run as root.

# debian_mirror: prints the mirror that this machine's apt uses, or fails.
debian_mirror() {
    local mirror
    mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.{list,sources} 2>/dev/null | grep -v '^#' |
        grep -oE 'https?://[^ ]*/debian/?( |$)' | head -1 || true)
    [[ -n "$mirror" ]] || { echo "apt has no mirror of Debian to make a new system from" >&2; return 1; }
    echo "${mirror% }"
}

# quietly LOG COMMAND...: shows the output of a command only if it fails.
quietly() {
    local log=$1
    shift
    "$@" >"$log" 2>&1 || { tail -n 40 "$log" >&2; return 1; }
}

# new_system RELEASE FOLDER [OPTIONS OF MMDEBSTRAP]: makes a minimal system with apt in a folder.
new_system() {
    local release=$1 folder=$2 mirror
    shift 2
    mirror=$(debian_mirror)
    quietly "$folder.log" mmdebstrap --variant=apt "$@" "$release" "$folder" "$mirror"
    cp /etc/apt/apt.conf.d/* "$folder/etc/apt/apt.conf.d/" 2>/dev/null || true
}

# enter FOLDER COMMAND...: runs a command in a system, with this machine's /proc, /sys and /dev where mounting them is
# allowed. The mounts end with the command.
enter() {
    local folder=$1
    shift
    local clean=(env -i HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin)
    if unshare --mount true 2>/dev/null; then
        unshare --mount bash -c 'for part in proc sys dev; do mount --rbind "/$part" "$0/$part" || true; done
            exec chroot "$0" "$@"' "$folder" "${clean[@]}" "$@"
    else
        chroot "$folder" "${clean[@]}" "$@"
    fi
}
