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
        install() {
            $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -qy --no-install-recommends "$@"
        }
        # A fresh machine has no lists.
        install "$@" || { $as_root apt-get update -q && install "$@"; }
    ) 9> "${TMPDIR:-/tmp}/jointsweep-packages.lock"
}
