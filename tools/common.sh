# shellcheck shell=bash
# What tools/run and tools/test share: being at home anywhere, installing what is missing, building with progress.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# say TEXT: what happens next, on standard error.
say() { printf '== %s\n' "$*" >&2; }

# fail CODE TEXT: the fault, and out.
fail() {
    local code=$1
    shift
    printf '%s: %s\n' "$(basename "$0")" "$*" >&2
    exit "$code"
}

# packages KIND...: the packages of tools/packages.txt of these kinds.
packages() {
    local kind name
    while read -r kind name; do
        for wanted in "$@"; do
            if [[ $kind == "$wanted" ]]; then printf '%s\n' "$name"; fi
        done
    done < "$root/tools/packages.txt"
}

# missing_packages KIND...: those of them that dpkg does not know as installed.
missing_packages() {
    local name
    packages "$@" | while read -r name; do
        [[ $(dpkg-query -W -f '${db:Status-Status}' "$name" 2> /dev/null) == installed ]] || printf '%s\n' "$name"
    done
}

is_debian_12() {
    [[ -r /etc/os-release ]] || return 1
    # shellcheck source=/dev/null
    (. /etc/os-release && [[ ${ID:-} == debian && ${VERSION_ID:-} == 12 ]])
}

# Elsewhere nothing is installed: the programs we call must be there, and CMake will name a library that is not.
require_programs() {
    local program missing=()
    for program in "$@"; do
        command -v "$program" > /dev/null || missing+=("$program")
    done
    [[ ${#missing[@]} -eq 0 ]] && return
    say "this is no Debian 12, so nothing is installed for you. Its packages are, for comparison:"
    packages build run test | paste -sd ' ' >&2
    fail 2 "not found: ${missing[*]}"
}

# install_packages KIND...: on Debian 12, installs what is missing with apt, as root or through sudo.
install_packages() {
    if ! is_debian_12; then
        require_programs c++ cmake ninja git glslangValidator python3
        return
    fi
    local missing=() as_root=()
    mapfile -t missing < <(missing_packages "$@")
    [[ ${#missing[@]} -eq 0 ]] && return
    if [[ $(id -u) -ne 0 ]]; then
        command -v sudo > /dev/null || fail 2 "not root, and there is no sudo. As root: apt-get install --no-install-recommends ${missing[*]}"
        as_root=(sudo)
    fi
    say "installing ${#missing[@]} packages: ${missing[*]}"
    "${as_root[@]}" apt-get -q update >&2
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends "${missing[@]}" >&2
}

# build PRESET [TARGET...]: configures where needed and builds, Ninja's own counter being the progress.
build() {
    local preset=$1
    shift
    say "configuring ($preset)"
    (cd "$root" && cmake --preset "$preset" > "$root/build/$preset.log" 2>&1) || {
        cat "$root/build/$preset.log" >&2
        fail 2 "configuring failed; the lines above say what is missing"
    }
    say "building ($preset)"
    (cd "$root" && cmake --build --preset "$preset" ${1:+--target "$@"} >&2)
}
