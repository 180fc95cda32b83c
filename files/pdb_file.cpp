#include "files/pdb_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "files/atomic_file.hpp"
#include "files/unit_cell.hpp"

namespace taut {
namespace {

constexpr int kMostNumbered = 99999;  // most atoms in five columns

// Returns the eight columns of a coordinate [Å].
std::string columns(double x) {
  for (int decimals = 3; decimals >= 0; --decimals)
    if (std::string text = fmt::format("{:8.{}f}", x, decimals); text.size() <= 8) return text;
  return x > 0 ? "99999999" : "-9999999";
}

// Elements of one letter leave the first of the four columns blank.
std::string atom_name(const AtomKind& kind) {
  const std::string name = kind.atom.substr(0, 4);
  return name.size() == 4 || kind.element.size() == 2 ? fmt::format("{:<4}", name)
                                                      : fmt::format(" {:<3}", name);
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

// X, as crystallographers write what they do not know, where there is none: readers guess an empty one by the atom's
// name, and take a bead B for boron.
std::string element_of(const AtomKind& kind) {
  return kind.element.empty() ? "X" : upper(kind.element);
}

}  // namespace

void write_pdb(const std::filesystem::path& file, const TrajectorySetup& setup, const State& s) {
  const System& sys = setup.sys;
  const Names& names = setup.names;
  std::string text = "REMARK   1 written by taut: positions unwrapped, molecules whole\n";
  if (!sys.reach.empty()) text += "REMARK   1 but for those bonded around the box: bonds of nearest images\n";
  const auto out = std::back_inserter(text);
  if (s.box.periodic()) {
    const auto [length, angle] = to_unit_cell(s.box);
    fmt::format_to(out, "CRYST1{:9.3f}{:9.3f}{:9.3f}{:7.2f}{:7.2f}{:7.2f} P 1           1\n", length[0],
                   length[1], length[2], angle[0], angle[1], angle[2]);
  }
  for (int a = 0; a < sys.atoms(); ++a) {
    const AtomKind& kind = names.kinds[names.kind[a]];
    fmt::format_to(
        out, "HETATM{:5} {} {:<4} {:4}    {}{}{}  1.00  0.00          {:>2}\n", (a + 1) % (kMostNumbered + 1),
        atom_name(kind), fmt::format("{:>3}", kind.residue.substr(0, 4)), (names.residue[a] + 1) % 10000,
        columns(10 * s.x(0, a)), columns(10 * s.x(1, a)), columns(10 * s.x(2, a)), element_of(kind));
  }
  const auto connect = [&](int i, int j) { fmt::format_to(out, "CONECT{:5}{:5}\n", i + 1, j + 1); };
  if (sys.atoms() <= kMostNumbered) {
    for (const RigidBond& bond : sys.bonds) connect(bond.i, bond.j);
    for (const auto& [i, j] : setup.further_bonds) connect(i, j);
  }
  text += "END\n";
  write_file(file, text);
}

}  // namespace taut
