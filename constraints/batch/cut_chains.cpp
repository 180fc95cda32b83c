#include "constraints/batch/cut_chains.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "constraints/batch/lanes.hpp"
#include "constraints/bond_graph.hpp"

namespace taut {
namespace {

// Atoms and bonds of a chain from one end to the other; bond b joins the atoms b and b + 1 of the path.
struct Path {
  std::vector<int> atoms, bonds;
};

// Whether atoms and bonds are numbered along the chain.
bool is_in_order(const ClusterShape& shape) {
  for (int b = 0; b < shape.bond_count(); ++b)
    if (shape.bonds[b].i != b || shape.bonds[b].j != b + 1) return false;
  return true;
}

std::optional<Path> path_of(const ClusterShape& shape) {
  if (is_in_order(shape)) {
    Path path{std::vector<int>(shape.atoms()), std::vector<int>(shape.bond_count())};
    std::iota(path.atoms.begin(), path.atoms.end(), 0);
    std::iota(path.bonds.begin(), path.bonds.end(), 0);
    return path;
  }
  const auto bonds_at = bonds_at_atoms(shape.atoms(), shape.bonds);
  const auto is_end = [](const std::vector<int>& bonds) { return bonds.size() == 1; };
  const auto end = std::find_if(bonds_at.begin(), bonds_at.end(), is_end);
  const bool branched = std::any_of(bonds_at.begin(), bonds_at.end(), [](auto& b) { return b.size() > 2; });
  if (end == bonds_at.end() || branched) return std::nullopt;

  Path path{{static_cast<int>(end - bonds_at.begin())}, {}};
  for (int b = 0; b < shape.bond_count(); ++b) {
    const int atom = path.atoms.back();
    const int bond = b == 0 || bonds_at[atom][0] != path.bonds.back() ? bonds_at[atom][0] : bonds_at[atom][1];
    path.bonds.push_back(bond);
    path.atoms.push_back(shape.bonds[bond].i == atom ? shape.bonds[bond].j : shape.bonds[bond].i);
  }
  return path;
}

// The first atom of each piece along the path, and the end of the last one.
using Cuts = std::vector<int>;

constexpr int kFewestAtoms = 4;

// Places as many pieces of `width` atoms as fit between ends of a few atoms.
Cuts cuts_of(int atoms, int pieces, int width) {
  const int head = (atoms - pieces * width) / 2;
  Cuts cuts{0};
  for (int p = 0; p <= pieces; ++p) cuts.push_back(head + p * width);
  cuts.push_back(atoms);
  return cuts;
}

// The part of the path from atom `from` to atom `to` − 1, with the atoms of its neighbours that it needs.
struct Piece {
  int first, atoms;  // along the path, neighbours' atoms included
  ClusterShape shape;
};

// With the two nearest atoms of each neighbour: the bond between them couples to the one between the pieces.
Piece piece_of(const ClusterShape& chain, const Path& path, int from, int to) {
  Piece piece;
  piece.shape.left = from == 0 ? 0 : 2;
  piece.shape.right = to == chain.atoms() ? 0 : 2;
  piece.first = from - piece.shape.left;
  piece.atoms = to + piece.shape.right - piece.first;
  for (int a = 0; a < piece.atoms; ++a)
    piece.shape.inv_mass.push_back(chain.inv_mass[path.atoms[piece.first + a]]);
  for (int b = 0; b + 1 < piece.atoms; ++b)
    piece.shape.bonds.push_back({b, b + 1, chain.bonds[path.bonds[piece.first + b]].length});
  return piece;
}

// Returns whether masses and lengths repeat after `width` atoms in all pieces between the ends.
bool repeats(const ClusterShape& chain, const Path& path, const Cuts& cuts, int width) {
  const int begin = cuts[1] - 2, end = cuts[cuts.size() - 2] + 2 - width;
  for (int a = begin; a < end; ++a)
    if (chain.inv_mass[path.atoms[a]] != chain.inv_mass[path.atoms[a + width]]) return false;
  for (int b = begin; b + 1 < end; ++b)
    if (chain.bonds[path.bonds[b]].length != chain.bonds[path.bonds[b + width]].length) return false;
  return true;
}

// Pieces of one width, whatever the chain's length is, so that those of many chains are alike.
std::optional<Cuts> find_common_cuts(const ClusterShape& chain, const Path& path) {
  constexpr int kWidth = 16;
  const int atoms = chain.atoms(), pieces = (atoms - 2 * kFewestAtoms) / kWidth;
  Cuts cuts = cuts_of(atoms, pieces, kWidth);
  return repeats(chain, path, cuts, kWidth) ? std::optional(cuts) : std::nullopt;
}

std::optional<Cuts> find_cuts(const ClusterShape& chain, const Path& path, int piece_bonds) {
  constexpr int kLongestPeriod = 16;
  const int atoms = chain.atoms(), pieces = kLanes * std::max(1, atoms / (kLanes * (piece_bonds + 1)));
  const int widest = (atoms - 2 * kFewestAtoms) / pieces;
  for (int width = widest; width >= std::max(kFewestAtoms, widest - kLongestPeriod + 1); --width) {
    Cuts cuts = cuts_of(atoms, pieces, width);
    if (repeats(chain, path, cuts, width)) return cuts;
  }
  return std::nullopt;
}

}  // namespace

bool is_chain(const ClusterShape& shape) {
  std::vector<int> bonds_at(shape.atoms());
  for (const auto& [i, j, d] : shape.bonds)
    if (++bonds_at[i] > 2 || ++bonds_at[j] > 2) return false;
  return shape.atoms() >= 2 * kFewestAtoms && shape.bond_count() + 1 == shape.atoms();
}

bool cut_chains(const ClusterBatch& batch, std::optional<int> piece_bonds, ClusterBatches& pieces,
                std::vector<std::vector<PieceOfChain>>& chains) {
  const std::optional<Path> path = path_of(batch.shape);
  if (!path) return false;
  const std::optional<Cuts> cuts =
      piece_bonds ? find_cuts(batch.shape, *path, *piece_bonds) : find_common_cuts(batch.shape, *path);
  if (!cuts) return false;

  for (int c = 0; c < batch.count; ++c) {
    const int *atoms = &batch.atoms[c * batch.shape.atoms()], *bonds = &batch.bonds[c * path->bonds.size()];
    std::vector<PieceOfChain> chain;
    for (std::size_t p = 0; p + 1 < cuts->size(); ++p) {
      const Piece piece = piece_of(batch.shape, *path, (*cuts)[p], (*cuts)[p + 1]);
      std::vector<int> its_atoms, its_bonds;
      for (int a = 0; a < piece.atoms; ++a) its_atoms.push_back(atoms[path->atoms[piece.first + a]]);
      for (int b = 0; b + 1 < piece.atoms; ++b) its_bonds.push_back(bonds[path->bonds[piece.first + b]]);
      const int where = pieces.add(piece.shape, its_atoms, its_bonds);
      chain.push_back({where, pieces.batches[where].count - 1});
    }
    chains.push_back(std::move(chain));
  }
  return true;
}

}  // namespace taut
