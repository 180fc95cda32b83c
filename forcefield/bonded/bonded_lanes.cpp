#include "forcefield/bonded/bonded_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "md/units.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "forcefield/bonded/bonded_lanes.cpp"
#include <hwy/foreach_target.h>
// after the targets: once a target
#include <hwy/contrib/math/math-inl.h>

#include "forcefield/bonded/term_blocks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// A force along the line of two atoms: `pull` times the vector from i to j acts on i, its opposite on j.
HWY_INLINE void pull_together(V pull, const V3& d, V3* f) {
  f[0] = pull * d;
  f[1] = -f[0];
}

// E = ½k(r − d)²
template <>
struct Law<HarmonicBond> {
  static std::array<double, 2> numbers(const HarmonicBond& t) { return {t.length, t.k}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V3 d = x[1] - x[0];
    const V r = hn::Sqrt(dot(d, d)), stretch = r - p[0], k_stretch = p[1] * stretch;
    pull_together(hn::IfThenZeroElse(r == 0, k_stretch / r), d, f);
    return 0.5 * k_stretch * stretch;
  }
};

// E = −½k r₀² ln(1 − (r/r₀)²) (Kremer and Grest 1990, doi:10.1063/1.458541)
template <>
struct Law<Fene> {
  static std::array<double, 2> numbers(const Fene& t) { return {t.k, t.r0 * t.r0}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V3 d = x[1] - x[0];
    const V slack = 1 - dot(d, d) / p[1];
    pull_together(p[0] / slack, d, f);
    const V energy = -0.5 * (p[0] * p[1]) * hn::Log(D(), slack);
    return hn::IfThenElse(slack > 0, energy, broadcast(std::numeric_limits<double>::quiet_NaN()));
  }
};

// E = 4ε((σ/r)¹² − (σ/r)⁶) + k qq/r, without cutoff or images
template <>
struct Law<PairException> {
  static std::array<double, 3> numbers(const PairException& t) {
    return {kCoulomb * t.charge_product, t.sigma * t.sigma, 4 * t.epsilon};
  }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V3 d = x[1] - x[0];
    const V inv_r2 = 1 / dot(d, d), s2 = p[1] * inv_r2, s6 = s2 * s2 * s2;
    const V coulomb = p[0] * hn::Sqrt(inv_r2), depth = p[2] * s6;
    const V virial = hn::MulAdd(depth, 12 * s6 - 6, coulomb);
    pull_together(-(virial * inv_r2), d, f);
    return hn::MulAdd(depth, s6 - 1, coulomb);
  }
};

// E = k_rf r² − c_rf, times the charges, within the cutoff
template <>
struct Law<FieldPair> {
  static std::array<double, 3> numbers(const FieldPair& t) {
    return {t.curvature, t.depth, t.cutoff * t.cutoff};
  }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V3 d = x[1] - x[0];
    const V r2 = dot(d, d);
    const auto beyond = r2 > p[2];
    pull_together(hn::IfThenZeroElse(beyond, 2 * p[0]), d, f);
    return hn::IfThenZeroElse(beyond, hn::MulSub(p[0], r2, p[1]));
  }
};

// E = ½k(θ − θ₀)². With a and c the arms at the middle atom and p = a × c,
//     θ = atan2(|p|, a·c),   ∂θ/∂x_i = a × p / (a²|p|),   ∂θ/∂x_k = −c × p / (c²|p|).
// Where the atoms are in line the direction is undefined and the forces are zero.
template <>
struct Law<HarmonicAngle> {
  static std::array<double, 2> numbers(const HarmonicAngle& t) { return {t.angle, t.stiffness}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V3 a = x[0] - x[1], c = x[2] - x[1], normal = cross(a, c);
    const V sine = hn::Sqrt(dot(normal, normal)), cosine = dot(a, c);
    const V bend = angle(sine, cosine) - p[0], moment = p[1] * bend;
    const V a2 = dot(a, a), c2 = dot(c, c);
    const V over = hn::IfThenZeroElse(sine == 0, moment / (a2 * c2 * sine));
    f[0] = -(over * c2) * cross(a, normal);
    f[2] = over * a2 * cross(c, normal);
    f[1] = -(f[0] + f[2]);
    return 0.5 * moment * bend;
  }

  // atan2(sine, cosine), sine ≥ 0
  static HWY_INLINE V angle(V sine, V cosine) {
    const V acute = hn::Atan(D(), sine / hn::Max(hn::Abs(cosine), broadcast(1e-300)));
    return hn::IfThenElse(cosine < 0, std::numbers::pi - acute, acute);
  }
};

// E(cos θ), cos θ = a·c/|a||c| with a and c the arms at the middle atom; F_i = −E'(c/|a||c| − cos θ a/a²), E' the
// slope that slope_at(cos θ) gives.
template <class Slope>
HWY_INLINE V cosine_forces(const V3* x, V3* f, const Slope& slope_at) {
  const V3 a = x[0] - x[1], c = x[2] - x[1];
  const V a2 = dot(a, a), c2 = dot(c, c);
  const V inverse = 1 / hn::Sqrt(a2 * c2);  // 1/|a||c|
  const V cosine = inverse * dot(a, c), slope = slope_at(cosine);
  const V over = slope * inverse, k_cosine = slope * cosine;
  f[0] = k_cosine / a2 * a - over * c;
  f[2] = k_cosine / c2 * c - over * a;
  f[1] = -(f[0] + f[2]);
  return cosine;
}

// E = K(1 + cos θ)
template <>
struct Law<CosineAngle> {
  static std::array<double, 1> numbers(const CosineAngle& t) { return {t.stiffness}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V cosine = cosine_forces(x, f, [p](V) HWY_ATTR { return p[0]; });
    return hn::MulAdd(p[0], cosine, p[0]);
  }
};

// E = ½K(cos θ − cos θ₀)²
template <>
struct Law<CosineSquaredAngle> {
  static std::array<double, 2> numbers(const CosineSquaredAngle& t) { return {t.cosine, t.stiffness}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    const V cosine = cosine_forces(x, f, [p](V at) HWY_ATTR { return p[1] * (at - p[0]); });
    const V off = cosine - p[0];
    return 0.5 * p[1] * (off * off);
  }
};

// E = ½K(c − c₀)²/(1 − c²), c = cos θ; dE/dc = K(c − c₀)(1 − c c₀)/(1 − c²)²
template <>
struct Law<RestrictedAngle> {
  static std::array<double, 2> numbers(const RestrictedAngle& t) { return {t.cosine, t.stiffness}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    V energy{};
    cosine_forces(x, f, [p, &energy](V at) HWY_ATTR {
      const V off = at - p[0], pull = p[1] * off / (1 - at * at);
      energy = 0.5 * pull * off;
      return pull * (1 - at * p[0]) / (1 - at * at);
    });
    return energy;
  }
};

struct TorsionEnergy {
  V energy, slope;  // E, dE/dφ [kJ/mol]
};

// The forces of any torsion, by the vectors of dihedral.hpp; energy_at(cos φ, sin φ) gives its TorsionEnergy.
// As B × A = −(F·B) G,
//     cos φ = A·B/|A||B|,  sin φ = −|G| F·B/|A||B|.
template <class Energy>
HWY_INLINE V torsion_forces(const V3* x, V3* f, const Energy& energy_at) {
  const V3 F = x[0] - x[1], G = x[1] - x[2], H = x[3] - x[2], A = cross(F, G), B = cross(H, G);
  const V g2 = dot(G, G), a2 = dot(A, A), b2 = dot(B, B), least = 1e-20 * g2;
  // not for NaN: it must show
  const auto undefined = hn::Or(a2 <= least * dot(F, F), b2 <= least * dot(H, H));
  const V g = hn::Sqrt(g2), inv_g = hn::IfThenZeroElse(undefined, 1 / g);
  const V inv_a2b2 = hn::IfThenZeroElse(undefined, 1 / (a2 * b2));
  const V inv_ab = hn::Sqrt(inv_a2b2);
  const V cosine = hn::IfThenElse(undefined, broadcast(1), dot(A, B) * inv_ab);
  const V sine = -(g * dot(F, B) * inv_ab);

  const TorsionEnergy at = energy_at(cosine, sine);
  const V3 a = at.slope * (b2 * inv_a2b2) * A, b = at.slope * (a2 * inv_a2b2) * B;
  const V3 s = dot(F, G) * inv_g * a - dot(H, G) * inv_g * b;
  f[0] = g * a;
  f[3] = -g * b;
  f[1] = -(s + f[0]);
  f[2] = s - f[3];
  return at.energy;
}

template <>
struct Law<ExpandedTorsion> {
  static std::array<double, 4> numbers(const ExpandedTorsion& t) {
    return {t.periodicity, t.amplitude, t.of_cosine, t.of_sine};
  }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    return torsion_forces(x, f, [p](V cosine, V sine) HWY_ATTR {
      V cos_n = cosine, sin_n = sine;  // of nφ, each lane as far as its own n
      for (double n = 2;; ++n) {
        const auto on = p[0] >= n;
        if (hn::AllFalse(D(), on)) break;
        const V next = hn::MulSub(cos_n, cosine, sin_n * sine);
        sin_n = hn::IfThenElse(on, cos_n * sine + sin_n * cosine, sin_n);
        cos_n = hn::IfThenElse(on, next, cos_n);
      }
      return TorsionEnergy{p[1] + p[3] * sin_n + p[2] * cos_n, p[0] * hn::MulSub(p[3], cos_n, p[2] * sin_n)};
    });
  }
};

template <>
struct Law<RyckaertBellemans> {
  static const std::array<double, 6>& numbers(const RyckaertBellemans& t) { return t.c; }

  static HWY_INLINE V forces(const V3* x, const V* c, V3* f) {
    return torsion_forces(x, f, [c](V cosine, V sine) HWY_ATTR {
      const V u = -cosine;
      V value = c[5], slope = broadcast(0);  // Horner
      for (int n = 4; n >= 0; --n) {
        slope = slope * u + value;
        value = value * u + c[n];
      }
      return TorsionEnergy{value, slope * sine};
    });
  }
};

// d = φ − φ₀ from its own cosine and sine.
template <>
struct Law<TurnedTorsion> {
  static std::array<double, 3> numbers(const TurnedTorsion& t) { return {t.stiffness, t.cosine, t.sine}; }

  static HWY_INLINE V forces(const V3* x, const V* p, V3* f) {
    return torsion_forces(x, f, [p](V cosine, V sine) HWY_ATTR {
      const V cos_d = sine * p[2] + cosine * p[1];
      const V sin_d = hn::MulSub(sine, p[1], cosine * p[2]);
      const V turn = hn::CopySign(Law<HarmonicAngle>::angle(hn::Abs(sin_d), cos_d), sin_d);
      const V moment = p[0] * turn;
      return TorsionEnergy{0.5 * moment * turn, moment};
    });
  }
};

// With F, G, A and B as above, |A| = |F||G| sin θ₁ and |B| = |H||G| sin θ₂, so that with p = |A||B| and c = A·B/p = cos φ
//     E = W p³ P(c),  W = (|F| G² |H|)⁻³,  P = Σ c_n cⁿ
//     ∂E/∂A = W((3P − cP') p B² A + P' p² B),  ∂E/∂B = W((3P − cP') p A² B + P' p² A)
// which are zero where three atoms are in line.
template <>
struct Law<BendingTorsion> {
  static const std::array<double, 5>& numbers(const BendingTorsion& t) { return t.c; }

  static HWY_INLINE V forces(const V3* x, const V* n, V3* f) {
    const V3 F = x[0] - x[1], G = x[1] - x[2], H = x[3] - x[2], A = cross(F, G), B = cross(H, G);
    const V f2 = dot(F, F), g2 = dot(G, G), h2 = dot(H, H), a2 = dot(A, A), b2 = dot(B, B);
    const V p2 = a2 * b2, p = hn::Sqrt(p2), c = hn::IfThenZeroElse(p == 0, dot(A, B) / p);
    V value = n[4], slope = broadcast(0);  // Horner
    for (int k = 3; k >= 0; --k) {
      slope = slope * c + value;
      value = value * c + n[k];
    }
    const V inverse = 1 / (f2 * g2 * g2 * h2), W = inverse * hn::Sqrt(inverse);
    const V energy = W * p2 * p * value, along = W * p * (3 * value - c * slope), across = W * p2 * slope;
    const V3 a = along * b2 * A + across * B, b = along * a2 * B + across * A;
    f[0] = 3 * energy / f2 * F - cross(G, a);
    f[3] = 3 * energy / h2 * H - cross(G, b);
    const V3 of_g = cross(a, F) + cross(b, H) - 6 * energy / g2 * G;
    f[1] = -(f[0] + of_g);
    f[2] = of_g - f[3];
    return energy;
  }
};

double add_forces(const TermSpan& terms, const double* x, double* f) {
  return std::visit([x, f]<class Term>(std::span<const Term> of_one_kind)
                        HWY_ATTR { return Block<Term>::add_all(of_one_kind, x, f); },
                    terms);
}

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace taut {

HWY_EXPORT(add_forces);

ExpandedTorsion::ExpandedTorsion(const PeriodicTorsion& t)
    : i(t.i),
      j(t.j),
      k(t.k),
      l(t.l),
      periodicity(t.periodicity),
      amplitude(t.amplitude),
      of_cosine(t.amplitude * std::cos(t.phase)),
      of_sine(t.amplitude * std::sin(t.phase)) {}

TurnedTorsion::TurnedTorsion(const HarmonicTorsion& t)
    : i(t.i),
      j(t.j),
      k(t.k),
      l(t.l),
      stiffness(t.stiffness),
      cosine(std::cos(t.angle)),
      sine(std::sin(t.angle)) {}

double add_term_forces(const TermSpan& terms, const Vectors& x, Vectors& f) {
  return HWY_DYNAMIC_DISPATCH(add_forces)(terms, x.data(), f.data());
}

}  // namespace taut
#endif
