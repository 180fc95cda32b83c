#include "forcefield/wca.hpp"

#include <cmath>

#include "forcefield/pair_sum.hpp"

namespace taut {
namespace {

constexpr int kBead = 1;               // the one kind of pair
constexpr double kBufferShare = 0.27;  // of the cutoff: 0.3σ

PairRules rules(const Wca& wca, int atoms) {
  return {std::vector<std::uint8_t>(atoms, kBead), wca.exclusions};
}

struct Law {  // of PairSum
  double sigma2, epsilon;

  void row(int) {}
  void load(int, int) {}
  PairTerm operator()(int, double r2) const {
    const double inv_r2 = 1 / r2, s2 = sigma2 * inv_r2, s6 = s2 * s2 * s2;
    return {epsilon * (4 * (s6 - 1) * s6 + 1), 24 * epsilon * (2 * s6 - 1) * s6 * inv_r2};
  }
};

}  // namespace

double WcaBeads::reach(const Wca& wca) {
  return std::pow(2.0, 1.0 / 6) * wca.sigma;
}

WcaBeads::WcaBeads(const Wca& wca, int atoms, const Box& box)
    : sigma2_(wca.sigma * wca.sigma),
      epsilon_(wca.epsilon),
      cutoff_(reach(wca)),
      box_(box),
      list_(rules(wca, atoms), box, {cutoff_, kBufferShare * cutoff_}) {}

double WcaBeads::add(const Vectors& x, Vectors& f) {
  list_.update(x);
  const PairList& pairs = list_.pairs()[kBead];
  Law law{sigma2_, epsilon_};
  return list_.needs_images() ? PairSum<true>(box_, cutoff_).add(pairs, law, list_.positions(), f)
                              : PairSum<false>(box_, cutoff_).add(pairs, law, list_.positions(), f);
}

}  // namespace taut
