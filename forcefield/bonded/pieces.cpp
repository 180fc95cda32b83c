#include "forcefield/bonded/pieces.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

namespace taut {
namespace {

constexpr int kLargest = 4;  // times a piece's terms: a molecule that has more is cut

// Adds where terms begin … end − 1, which hang together, are cut into pieces of about as many terms: between terms of
// unlike lowest atoms.
void cut(const std::vector<TermAtoms>& terms, int begin, int end, int terms_of_piece,
         std::vector<int>& cuts) {
  const int count = end - begin, pieces = count > kLargest * terms_of_piece ? count / terms_of_piece : 1;
  cuts.push_back(begin);
  for (int p = 1; p < pieces; ++p) {
    int at = std::max(begin + Share(count, p, pieces).begin, cuts.back() + 1);
    while (at < end && terms[at].lowest() == terms[at - 1].lowest()) ++at;
    if (at < end) cuts.push_back(at);
  }
}

// The first term of each piece, and the end. A stretch ends at an atom that no term before it touches, once it has
// enough terms.
std::vector<int> find_cuts(const std::vector<TermAtoms>& terms, int terms_of_piece) {
  std::vector<int> cuts;
  const int count = static_cast<int>(terms.size());
  for (int begin = 0, end = 0, highest = -1; begin < count; begin = end) {
    for (; end < count && (end - begin < terms_of_piece || terms[end].lowest() <= highest); ++end)
      highest = std::max(highest, terms[end].highest());
    cut(terms, begin, end, terms_of_piece, cuts);
  }
  cuts.push_back(count);
  return cuts;
}

}  // namespace

Pieces::Pieces(std::vector<TermAtoms> terms, int terms_of_piece) {
  std::ranges::stable_sort(terms, {}, &TermAtoms::lowest);
  int atoms = 0;
  for (const TermAtoms& term : terms) atoms = std::max(atoms, term.highest() + 1);
  std::vector<std::uint64_t> phases_of(atoms);  // bit p: of an atom that a piece of phase p touches
  const std::vector<int> cuts = find_cuts(terms, terms_of_piece);
  for (std::size_t p = 0; p + 1 < cuts.size(); ++p) {
    const std::span<const TermAtoms> piece(terms.data() + cuts[p], terms.data() + cuts[p + 1]);
    std::uint64_t taken = 0;
    for (const TermAtoms& term : piece)
      for (const int atom : term.atoms) taken |= phases_of[atom];
    std::size_t phase = std::countr_one(taken);
    if (phase == 64) phase = std::max(phase, phases_.size());  // a phase of its own
    if (phases_.size() <= phase) phases_.resize(phase + 1);
    for (const TermAtoms& term : piece)
      for (const int atom : term.atoms)
        if (phase < 64) phases_of[atom] |= std::uint64_t{1} << phase;
    phases_[phase].pieces.push_back(static_cast<int>(p));
    phases_[phase].terms += static_cast<long>(piece.size());
    first_.push_back(piece.front().lowest());
  }
}

}  // namespace taut
