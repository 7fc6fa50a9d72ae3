# Debian packages that checks need, for scripts that source this file. Checks run side by side, and one installs at a time.

# 1 where this user may not, or where there is no such package.
install_packages() { # packages
    local as_root=""
    if [ "$(id -u)" != 0 ]; then
        sudo -n true 2> /dev/null || return 1
        as_root="sudo -n"
    fi
    (
        flock 9
        # What a package starts is not to keep the lock.
        apt() {
            $as_root env DEBIAN_FRONTEND=noninteractive apt-get -qy "$@" 9>&-
        }
        # A fresh machine has no lists.
        apt install --no-install-recommends "$@" || { apt update && apt install --no-install-recommends "$@"; }
    ) 9> "${TMPDIR:-/tmp}/jointsweep-packages.lock"
}
