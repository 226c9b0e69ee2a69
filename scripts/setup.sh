# Sourced by run-demo, run-tests and the experiments: install what is missing, configure, build.

# What the project needs, as Debian 12 packages.
CANONPOSE_PACKAGES="
  g++ cmake ninja-build pkg-config
  libtorch-dev libopenblas-pthread-dev
  libeigen3-dev libceres-dev libhdf5-dev libzip-dev zlib1g-dev libmatio-dev libtinygltf-dev
  nlohmann-json3-dev libcli11-dev libfmt-dev libspdlog-dev libtomlplusplus-dev libpugixml-dev libyaml-cpp-dev
  libopencv-videoio-dev libopencv-imgcodecs-dev libopencv-imgproc-dev
  python3-dev pybind11-dev python3-numpy python3-pytest python3-h5py
  esbuild libjs-three
  libgtest-dev libgmock-dev"

say() { printf '\n== %s\n' "$*" >&2; }

install_packages() {
  local missing=()
  local package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  if ! command -v apt-get >/dev/null; then
    echo "error: these Debian 12 packages are needed, and there is no apt-get to install them: ${missing[*]}" >&2
    exit 2
  fi
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "error: not root and no sudo; ask an administrator to run: apt-get install ${missing[*]}" >&2
      exit 2
    fi
    root=(sudo)
  fi
  say "installing ${missing[*]}"
  local log
  log=$(mktemp)
  if ! { "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update &&
         "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "error: installing packages failed; the whole log is $log" >&2
    exit 2
  fi
  rm -f "$log"
}

# build_folder PRESET: where the preset builds (CMakePresets.json).
build_folder() {
  [ "$1" = release ] && echo build || echo "build-$1"
}

# forget_other_place PRESET: removes the build folder if the source folder was moved or copied, because CMake refuses to use it then.
forget_other_place() {
  local folder home
  folder=$(build_folder "$1")
  home=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$folder/CMakeCache.txt" 2>/dev/null) || return 0
  [ -z "$home" ] || [ "$home" = "$PWD" ] || rm -rf "$folder"
}

# build PRESET TARGET...: configures and builds; shows one line of progress on a terminal, and everything if it fails.
build() {
  local preset=$1
  shift
  forget_other_place "$preset"
  local log
  log=$(mktemp)
  if ! cmake --preset "$preset" >"$log" 2>&1; then
    cat "$log" >&2
    echo "error: configuring failed; a fresh Debian 12 with the packages in scripts/setup.sh is known to work" >&2
    exit 2
  fi
  rm -f "$log"
  cmake --build --preset "$preset" --target "$@" >&2
}
