# Sourced by the scripts beside it: a Debian in a folder, and commands that run in it.
#   TAUT_ROOTS  the folder for roots and their logs (/var/tmp/taut-roots)
# The script that sources this sets `root`, `log` and `environment`, and calls `make_root SUITE` first.
((EUID == 0)) && command -v debootstrap >/dev/null || { echo "portability: needs root and debootstrap" >&2; exit 3; }
tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
roots=${TAUT_ROOTS:-/var/tmp/taut-roots}
environment=()
mounts=()

bind() {  # bind FOLDER PLACE: shows FOLDER at PLACE in the root
  mkdir -p "$root/$2"
  mount --rbind --make-rslave "$1" "$root/$2"
  mounts+=("$root/$2")
}
unbind() {
  local mount
  for mount in "${mounts[@]}"; do umount --recursive --lazy "$mount" || return; done
  mounts=()
}
remove_root() { unbind && { [[ ${TAUT_KEEP:-} ]] || rm -rf --one-file-system "$root"; }; }
inside() {
  chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    PIP_CERT=/etc/ssl/certs/ca-certificates.crt \
    "${environment[@]}" "$@"
}
must() {  # must WHAT COMMAND...: runs it into the log, and tells where it failed
  local what=$1
  shift
  "$@" >>"$log" 2>&1 || { tail -n 30 "$log" >&2; echo "portability: $what failed, see $log" >&2; exit 1; }
}
make_root() {  # make_root SUITE: debootstrap where the folder is not a Debian yet
  local mirror newer=()
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Label: Debian' | head -n 1)
  [[ $mirror ]] || { echo "portability: apt here knows no mirror of Debian" >&2; exit 3; }
  mkdir -p "$roots"
  : >"$log"
  # A suite that debootstrap is too old to know is made as the last one that it knows.
  [[ -e /usr/share/debootstrap/scripts/$1 ]] || newer=(/usr/share/debootstrap/scripts/trixie)
  [[ -e $root/etc/debian_version ]] ||
    must debootstrap debootstrap --variant=minbase --include=ca-certificates "$1" "$root" "$mirror" "${newer[@]}"
  echo "deb-src $mirror $1 main" >"$root/etc/apt/sources.list.d/sources.list"
  bind /proc proc
  bind /dev dev
  # A mirror may be older than its list of testing is valid for.
  echo 'Acquire::Check-Valid-Until "false";' >"$root/etc/apt/apt.conf.d/90-of-any-age"
  printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"  # no daemon is started in it
  chmod +x "$root/usr/sbin/policy-rc.d"
  cp /etc/resolv.conf "$root/etc/resolv.conf"
  cp /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/"  # what this machine trusts, for pip
}
install_in_root() {
  must apt-get inside apt-get -q update
  must apt-get inside apt-get -q -y --no-install-recommends -o Dpkg::Use-Pty=0 install "$@"
}
copy_tree() {  # to /taut in the root, without what git ignores
  rm -rf "$root/taut"
  mkdir "$root/taut"
  git -C "$tree" ls-files -z --cached --others --exclude-standard |
    tar -C "$tree" --null --ignore-failed-read -T - -c 2>/dev/null | tar -C "$root/taut" -x
}
