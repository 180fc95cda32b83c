#include "forcefield/pair_list.hpp"

namespace taut {

PairSorter::PairSorter(const PairRules& rules)
    : kind_(rules.kind), excluded_begin_(kind_.size() + 1, 0), excluded_from_(kind_.size(), -1) {
  for (const auto& [i, j] : rules.exclusions) {
    ++excluded_begin_[i + 1];
    ++excluded_begin_[j + 1];
  }
  for (std::size_t a = 0; a < kind_.size(); ++a) excluded_begin_[a + 1] += excluded_begin_[a];
  excluded_.resize(2 * rules.exclusions.size());
  std::vector<int> next(excluded_begin_.begin(), excluded_begin_.end() - 1);
  for (const auto& [i, j] : rules.exclusions) {
    excluded_[next[i]++] = j;
    excluded_[next[j]++] = i;
  }
}

void PairSorter::add_row(const Candidates& candidates, PairLists& lists) {
  const auto& [atom, partners, count, shift] = candidates;
  for (int e = excluded_begin_[atom]; e < excluded_begin_[atom + 1]; ++e) excluded_from_[excluded_[e]] = atom;

  std::array<int, kPairKinds> begin, end;
  std::array<int*, kPairKinds> out;
  for (int kind = 0; kind < kPairKinds; ++kind) {  // room for all of them in each list
    auto& list = lists[kind].partners;
    begin[kind] = end[kind] = static_cast<int>(list.size());
    list.resize(list.size() + count);
    out[kind] = list.data();
  }
  for (int c = 0; c < count; ++c) {
    const int j = partners[c];
    const int kind = excluded_from_[j] == atom ? 0 : kind_[atom] & kind_[j];
    out[kind][end[kind]++] = j;
  }
  end[0] = begin[0];
  for (int kind = 0; kind < kPairKinds; ++kind) {
    lists[kind].partners.resize(end[kind]);
    if (end[kind] > begin[kind]) lists[kind].rows.push_back({atom, begin[kind], end[kind], shift});
  }
}

}  // namespace taut
