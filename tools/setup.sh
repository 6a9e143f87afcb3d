# Sourced by tools/play and tools/test: installs what is missing, configures and builds. Says what it does.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '== %s\n' "$*"; }

# Packages of tools/packages.txt that dpkg does not have.
missing_packages() {
  local package
  grep -v '^#' tools/packages.txt | while read -r package; do
    [ "$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null | tr -d ' ')" = ii ] || echo "$package"
  done
}

install_packages() {
  command -v dpkg-query >/dev/null || { say "not a Debian system: install what tools/packages.txt lists"; return; }
  local missing
  missing=$(missing_packages)
  [ -n "$missing" ] || return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "these packages are missing, and there is no sudo:" $missing >&2; exit 2; }
    as_root=(sudo)
  fi
  say "installing" $missing
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

# build_preset PRESET [target...]: configures where that was not done yet.
build_preset() {
  local preset=$1
  shift
  if [ ! -f "build/$preset/build.ninja" ]; then
    say "configuring build/$preset"
    local launcher=()
    if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
    cmake --preset "$preset" "${launcher[@]}" >/dev/null
  fi
  say "building build/$preset"
  cmake --build --preset "$preset" ${@:+--target "$@"}
}
