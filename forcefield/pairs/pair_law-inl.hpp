// The pair potential in SIMD lanes. Included once a target.
#if defined(TAUT_PAIR_LAW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_PAIR_LAW_INL
#undef TAUT_PAIR_LAW_INL
#else
#define TAUT_PAIR_LAW_INL
#endif

#include <cstddef>

#include "base/inverses-inl.hpp"
#include "forcefield/pairs/pair_lanes-inl.hpp"
#include "forcefield/pairs/screening-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// What a kernel sums, and of which rows.
struct Choice {
  bool lj = false, charge = false;
  Mixing mixing = Mixing::kOneSigma;
  Ask ask = Ask::kForces;
  bool switched = false;  // sums: always, with S = 1 where the law has no switch
  bool fine = false;      // Ewald's screening with any number of terms

  constexpr bool one_sigma() const { return mixing == Mixing::kOneSigma; }
  constexpr bool table() const { return mixing == Mixing::kTable; }
  constexpr bool energy() const { return ask == Ask::kEnergy; }
  constexpr bool virial() const { return ask == Ask::kVirial; }
  constexpr bool sums() const { return ask != Ask::kForces; }
  // What the law starts from: 1/r, for energies and switches; 1/r³, for charges; 1/r², without them.
  constexpr bool from_root() const { return switched || (charge && energy()); }
  constexpr bool from_cube() const { return charge && !from_root(); }
};

// PairLaw in vectors of a Shape<T>.
template <class T, Choice choice>
class LawInLanes {
  using D = typename Shape<T>::D;
  using V = typename Shape<T>::V;

 public:
  // Parameters of the row's atoms in a vector.
  struct Atoms {
    V q, eps, half_sigma;
    V repulsion, attraction;  // 12 σ¹² and 6 σ⁶, times eps
    V line;                   // of the table
  };

  HWY_INLINE LawInLanes(const PairLaw& law, const PairAtoms<T>& atoms)
      : charge_(atoms.charge.data()),
        half_sigma_(atoms.half_sigma.data()),
        two_sqrt_epsilon_(atoms.two_sqrt_epsilon.data()),
        type_(atoms.type.data()),
        table_a_(atoms.table_a.data()),
        table_b_(atoms.table_b.data()),
        types_(set(law.types)),
        k_rf_(set(law.k_rf)),
        two_k_rf_(set(2 * law.k_rf * kScale)),
        c_rf_(set(law.c_rf)),
        sigma6_(set(law.sigma6())),
        six_sigma6_(set(kSix * law.sigma6())),
        twelve_sigma12_(set(kTwelve * law.sigma6() * law.sigma6())),
        raised_(set(law.raised())),
        shift_inv_r6_(set(law.shift_inv_r6)),
        screen_(law.screening.scale, choice.energy() ? law.screening.energy : law.screening.force, kScale) {
    if (choice.switched && law.switched()) {
      const double width = law.cutoff - law.switch_distance;
      inv_width_ = set(1 / width);
      start_ = set(law.switch_distance / width);
      slope_width_ = set(30 / width);
    }
  }

  // Those from slot `first` on.
  HWY_INLINE void load(int first, Atoms& a) const {
    const D d;
    if constexpr (choice.charge) a.q = load_rows(d, charge_ + first) * T(1 / kScale);
    if constexpr (choice.table()) {
      a.line = load_rows(d, type_ + first) * types_ + T(kWhole);
    } else if constexpr (choice.lj) {
      a.eps = load_rows(d, two_sqrt_epsilon_ + first);
      a.repulsion = a.eps * twelve_sigma12_;
      a.attraction = a.eps * six_sigma6_;
      if constexpr (!choice.one_sigma()) a.half_sigma = load_rows(d, half_sigma_ + first);
    }
  }

  // Whether charges act by Ewald's real space.
  HWY_INLINE bool screened() const { return choice.charge && screen_.wanted(); }

  // What pairs() starts from.
  static HWY_INLINE V guess(V r2) {
    return choice.from_root() || choice.from_cube() ? guess_inverse_sqrt(D(), r2) : guess_inverse(D(), r2);
  }

  // The guess becomes 1/r³, 1/r or 1/r².
  template <int K>
  static HWY_INLINE void invert(const V (&r2)[K], V (&guess)[K]) {
    const D d;
    if constexpr (choice.from_cube()) {
      inverse_cube<K>(d, r2, guess);
    } else if constexpr (choice.from_root()) {
      inverse_sqrt<K>(d, r2, guess);
    } else {
      inverse<K>(d, r2, guess);
    }
  }

  // −(dE/dr)/r [kJ/mol/nm²], or E [kJ/mol], of a row's vector with K clusters' atoms from slots j on.
  template <int K>
  HWY_INLINE void pairs(const Atoms& atoms, const std::ptrdiff_t (&j)[K], const V (&r2)[K], V (&guess)[K],
                        bool screened, V (&term)[K]) const {
    V coulomb[K];
    find_coulomb<K>(r2, guess, screened, coulomb);
    for (int k = 0; k < K; ++k) {
      if constexpr (choice.lj) term[k] = lennard_jones(atoms, column(j[k]), r2[k], guess[k]);
      if constexpr (choice.charge) {
        const V qq = atoms.q * load_columns(D(), charge_ + j[k]);
        term[k] = choice.lj ? hn::MulAdd(qq, coulomb[k], term[k]) : qq * coulomb[k];
      }
    }
  }

  // The same in two steps, with one σ: what depends on the distances alone, and pairs' terms of it.
  template <int K>
  HWY_INLINE void of_distances(const V (&r2)[K], V (&coulomb)[K], V (&lj)[K]) const {
    V inverse[K];
    for (int k = 0; k < K; ++k) inverse[k] = guess(r2[k]);
    invert<K>(r2, inverse);
    find_coulomb<K>(r2, inverse, screened(), coulomb);
    if constexpr (choice.lj) {
      Atoms atoms{};
      atoms.eps = set(1);
      atoms.repulsion = twelve_sigma12_;
      atoms.attraction = six_sigma6_;
      Column column;
      column.eps = set(1);
      for (int k = 0; k < K; ++k) lj[k] = lennard_jones(atoms, column, r2[k], inverse[k]);
    }
  }
  HWY_INLINE V term(const Atoms& atoms, std::ptrdiff_t j, V coulomb, V lj) const {
    const D d;
    V term{};
    if constexpr (choice.lj) term = atoms.eps * load_columns(d, two_sqrt_epsilon_ + j) * lj;
    if constexpr (choice.charge) {
      const V qq = atoms.q * load_columns(d, charge_ + j);
      term = choice.lj ? hn::MulAdd(qq, coulomb, term) : qq * coulomb;
    }
    return term;
  }

 private:
  static HWY_INLINE V set(double value) { return hn::Set(D(), static_cast<T>(value)); }

  // Of unit charges.
  template <int K>
  HWY_INLINE void find_coulomb(const V (&r2)[K], const V (&guess)[K], bool screened, V (&coulomb)[K]) const {
    V inv_r3[K];
    for (int k = 0; k < K; ++k) {
      if constexpr (choice.from_cube()) inv_r3[k] = guess[k];
      if constexpr (choice.from_root()) inv_r3[k] = guess[k] * (guess[k] * guess[k]);
    }
    if constexpr (choice.charge) {
      if (screened) {
        screen_(r2, coulomb);
        for (int k = 0; k < K; ++k) coulomb[k] = (choice.energy() ? guess[k] : inv_r3[k]) - coulomb[k];
      } else {
        for (int k = 0; k < K; ++k)
          coulomb[k] = choice.energy() ? guess[k] + k_rf_ * r2[k] - c_rf_ : inv_r3[k] - two_k_rf_;
      }
    }
  }

  // Parameters of a j-cluster's atoms, from slot j on.
  struct Column {
    V eps, half_sigma, type;
  };
  HWY_INLINE Column column(std::ptrdiff_t j) const {
    const D d;
    Column c;  // not cleared: what the law does not take is not loaded
    if constexpr (choice.table()) {
      c.type = load_columns(d, type_ + j);
    } else {
      c.eps = load_columns(d, two_sqrt_epsilon_ + j);
      if constexpr (!choice.one_sigma()) c.half_sigma = load_columns(d, half_sigma_ + j);
    }
    return c;
  }

  // 1/r³ comes times kScale: so do 1/r⁶ and what follows from it, times its square.
  static constexpr double kScale = choice.from_cube() ? kCubeScale<D> : 1, kScale2 = kScale * kScale;
  static constexpr double kSix = 6 / (kScale2 * kScale2), kTwelve = 12 / (kScale2 * kScale2 * kScale2);

  // `inverse`: 1/r³, 1/r or 1/r².
  HWY_INLINE V lennard_jones(const Atoms& atoms, const Column& j, V r2, V inverse) const {
    const D d;
    V inv_r2, inv_r4, inv_r6;
    if constexpr (choice.from_cube()) {
      inv_r6 = inverse * inverse;
      inv_r4 = inv_r6 * r2;
      inv_r2 = inv_r4 * r2;
    } else {
      inv_r2 = choice.from_root() ? inverse * inverse : inverse;
      inv_r4 = inv_r2 * inv_r2;
      inv_r6 = inv_r4 * inv_r2;
    }
    V slope{}, energy{}, raised{};
    constexpr bool needs_slope = !choice.energy() || choice.switched,
                   needs_energy = choice.energy() || choice.switched;
    if constexpr (choice.table()) {
      const auto at = place_in_table(atoms.line + j.type);
      const V b = hn::GatherIndex(d, table_b_, at), a = hn::GatherIndex(d, table_a_, at);
      const V a_over_r6 = a * inv_r6;
      if constexpr (needs_slope) slope = inv_r4 * inv_r4 * hn::MulSub(set(kTwelve), a_over_r6, T(kSix) * b);
      if constexpr (needs_energy) energy = inv_r6 * (a_over_r6 - b);
      if constexpr (choice.energy()) raised = shift_inv_r6_ * (b - a * shift_inv_r6_);
    } else {
      if constexpr (choice.one_sigma() && !choice.switched && !choice.energy())
        return inv_r4 * (inv_r4 * j.eps) * (atoms.repulsion * inv_r6 - atoms.attraction);
      V s6;
      if constexpr (choice.one_sigma()) {
        s6 = sigma6_ * inv_r6;
      } else {
        const V sigma = atoms.half_sigma + j.half_sigma, sigma2 = sigma * sigma;
        if constexpr (choice.from_cube()) {
          s6 = sigma2 * sigma2 * sigma2 * inv_r6;
        } else {
          const V s2 = sigma2 * inv_r2;
          s6 = s2 * s2 * s2;
        }
      }
      const V four_eps = atoms.eps * j.eps, depth = four_eps * s6;
      if constexpr (needs_slope) slope = depth * (T(kTwelve) * s6 - T(kSix)) * inv_r2;
      if constexpr (needs_energy) energy = depth * s6 - depth;
      if constexpr (choice.energy()) raised = raised_of(atoms, j) * four_eps;
    }
    if constexpr (choice.switched) apply_switch(r2, inverse, slope, energy);
    if constexpr (!choice.energy()) return slope;
    return energy + raised;
  }

  // In units of 4ε.
  HWY_INLINE V raised_of(const Atoms& atoms, const Column& j) const {
    if constexpr (choice.one_sigma()) return raised_;
    const V sigma = atoms.half_sigma + j.half_sigma, sigma2 = sigma * sigma;
    const V s6 = sigma2 * sigma2 * sigma2 * shift_inv_r6_;
    return s6 - s6 * s6;
  }

  // S = 1 − u³(10 − 15u + 6u²), S' = −30 (u − u²)²; the force gains −E S'/r
  HWY_INLINE void apply_switch(V r2, V inv_r, V& slope, V& energy) const {
    const V u = hn::Max(r2 * inv_r * inv_width_ - start_, hn::Zero(D()));
    const V u2 = u * u, u_less_u2 = u - u2;
    const V left = 1 - u2 * u * (10 - u * (15 - 6 * u));
    const V slope_of_it = u_less_u2 * u_less_u2 * slope_width_;
    slope = slope * left + energy * slope_of_it * inv_r;
    energy *= left;
  }

  // A whole number added to kWhole is in the low bits of the sum.
  static constexpr double kWhole = sizeof(T) == 8 ? 0x1p52 : 0x1p23;
  static HWY_INLINE auto place_in_table(V line_and_column) {
    const hn::RebindToSigned<D> d;
    return hn::And(hn::BitCast(d, line_and_column), hn::Set(d, (hn::TFromD<decltype(d)>{1} << 22) - 1));
  }

  const T* HWY_RESTRICT charge_;
  const T* HWY_RESTRICT half_sigma_;
  const T* HWY_RESTRICT two_sqrt_epsilon_;
  const T* HWY_RESTRICT type_;
  const T* HWY_RESTRICT table_a_;
  const T* HWY_RESTRICT table_b_;
  V types_;
  V k_rf_, two_k_rf_, c_rf_, sigma6_, six_sigma6_, twelve_sigma12_, raised_, shift_inv_r6_;
  V start_{}, inv_width_{}, slope_width_{};
  ScreenInLanes<D, choice.fine> screen_;
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
