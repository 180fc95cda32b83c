#include "forcefield/pme/mesh.hpp"

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <utility>

#include "forcefield/pme/fourier.hpp"
#include "forcefield/pme/mesh_kernels.hpp"
#include "md/threads.hpp"

namespace taut {
namespace {

constexpr int kAtomsPerThread = 200;  // fewer are not worth a thread

// |b(m)|⁻² = |Σ_k M_n(k + 1) e^(2πimk/size)|² (eq. 4.4), m = 0 … size − 1. Where it is zero, at size/2 of odd
// orders, the mean of its neighbours, as OpenMM has it.
std::vector<double> spline_moduli(int order, int size) {
  double weight[3 * kMostOrder], slope[3 * kMostOrder];
  const std::array<double, 3> on_a_point{};
  const int first = 0;
  find_splines(order, {&on_a_point, &first, 1}, {weight, slope});
  std::vector<double> moduli(size);
  for (int m = 0; m < size; ++m) {
    std::complex<double> sum = 0;
    for (int k = 0; k < order; ++k)
      sum += weight[k] * std::polar(1.0, 2 * std::numbers::pi * double(long(m) * k % size) / size);
    moduli[m] = std::norm(sum);
  }
  for (int m = 0; m < size; ++m)
    if (moduli[m] < 1e-7) moduli[m] = (moduli[(m + size - 1) % size] + moduli[(m + 1) % size]) / 2;
  return moduli;
}

double square(double a) {
  return a * a;
}

}  // namespace

class PmeMesh::Impl {
 public:
  Impl(const Eigen::VectorXd& charge, const PmeParameters& p)
      : order_(p.order), alpha_(p.alpha), size_(p.grid), grid_(p.grid, kMostOrder) {
    for (int a = 0; a < charge.size(); ++a)
      if (charge[a] != 0) charged_.push_back({a, charge[a]});
    const std::size_t n = charged_.size();
    point_.resize(n);
    above_.resize(n);
    place_.resize(n);
    atoms_.resize(n);
    for (auto* of_splines : {&weight_, &slope_}) of_splines->resize(3 * MeshSplines::room(order_) * n);
    begin_.resize(size_[0] + 1);
    for (int d = 0; d < 3; ++d) moduli_[d] = spline_moduli(order_, size_[d]);
    influence_.resize(std::size_t(size_[0]) * size_[1] * grid_.half());
    energy_of_.resize(size_[1]);
    virial_of_.resize(size_[1]);
  }

  void set_box(const Box& box) {
    box_ = box;
    const int threads = available_threads();
    in_parallel(threads, [&](int t) {
      const Share share(size_[1], t, threads);
      for (int row = share.begin; row < share.end; ++row) lay_influence(row);
    });
  }

  void add_forces(const Vectors& x, Vectors& f) {
    const int n = static_cast<int>(charged_.size()), threads = this->threads();
    spread_and_transform(x);
    in_parallel(threads, [&](int t) {
      const Share share(size_[1], t, threads);
      for (int row = share.begin; row < share.end; ++row) {
        grid_.transform_across(row);
        apply_influence(row);
        grid_.transform_back_across(row);
      }
    });
    in_parallel(threads, [&](int t) {
      const Share share(size_[0], t, threads);
      for (int plane = share.begin; plane < share.end; ++plane) {
        grid_.transform_plane_back(plane);
        repeat_row_starts(plane);
      }
    });
    in_parallel(threads, [&](int t) { gather(Share(n, t, threads), f); });
  }

  double energy() const { return std::accumulate(energy_of_.begin(), energy_of_.end(), 0.0); }

  Eigen::Matrix3d virial(const Vectors& x) {
    const int threads = this->threads();
    spread_and_transform(x);
    in_parallel(threads, [&](int t) {
      const Share share(size_[1], t, threads);
      for (int row = share.begin; row < share.end; ++row) {
        grid_.transform_across(row);
        virial_of_[row] = virial_of(row);
      }
    });
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Eigen::Matrix3d& of_row : virial_of_) sum += of_row;
    return sum;
  }

 private:
  struct Charged {
    int atom;
    double charge;
  };

  int threads() const {
    return std::clamp(static_cast<int>(charged_.size()) / kAtomsPerThread, 1, available_threads());
  }

  // The charges on the grid, transformed within each plane.
  void spread_and_transform(const Vectors& x) {
    const int n = static_cast<int>(charged_.size()), threads = this->threads();
    next_.resize(std::size_t(threads) * size_[0]);
    in_parallel(threads, [&](int t) { find_points(x, Share(n, t, threads), next_of(t)); });
    sort_by_plane(threads);
    in_parallel(threads, [&](int t) { lay_splines(Share(n, t, threads), next_of(t)); });
    in_parallel(threads, [&](int t) {
      const Share share(size_[0], t, threads);
      for (int plane = share.begin; plane < share.end; ++plane) {
        spread(plane);
        grid_.transform_plane(plane);
      }
    });
  }

  // The wave vectors m of the row k₂ of plane k₁ [1/nm].
  struct Waves {
    Vec3 first;   // k₃ = 0
    double step;  // along z
    Vec3 operator[](int k3) const { return {first.x(), first.y(), first.z() + k3 * step}; }
  };
  Waves waves(int k1, int k2) const {
    const auto whole = [&](int d, int k) { return double(k <= size_[d] / 2 ? k : k - size_[d]); };
    return {box_.reciprocal({whole(0, k1), whole(1, k2), 0}), 1 / box_.edge.z()};
  }

  // G of a row of every plane.
  void lay_influence(int row) {
    const double pi = std::numbers::pi, inv = pi * pi / (alpha_ * alpha_);
    double* g = influence_of(row);
    for (int k1 = 0; k1 < size_[0]; ++k1) {
      const Waves m = waves(k1, row);
      const double factor = pi * box_.volume() * moduli_[0][k1] * moduli_[1][row];
      for (int k3 = 0; k3 < grid_.half(); ++k3, ++g) {
        const double m2 = m[k3].squaredNorm();
        *g = m2 > 0 ? std::exp(-inv * m2) / (factor * moduli_[2][k3] * m2) : 0;
      }
    }
  }
  double* influence_of(int row) { return influence_.data() + std::ptrdiff_t{row} * size_[0] * grid_.half(); }

  // Where they are, and how many in each plane.
  void find_points(const Vectors& x, const Share& share, int* count) {
    std::fill_n(count, size_[0], 0);
    for (int c = share.begin; c < share.end; ++c) {
      const Vec3 s = box_.fractional(x.col(charged_[c].atom));
      for (int d = 0; d < 3; ++d) {
        const double at = (s[d] - std::floor(s[d])) * size_[d];
        const int point = std::min(static_cast<int>(at), size_[d] - 1);  // rounding on a wall
        point_[c][d] = point;
        above_[c][d] = at - point;
      }
      ++count[point_[c][0]];
    }
  }
  int* next_of(int thread) { return next_.data() + std::ptrdiff_t{thread} * size_[0]; }

  // Where each thread's atoms come, plane by plane and in their own order.
  void sort_by_plane(int threads) {
    int begin = 0;
    for (int plane = 0; plane < size_[0]; ++plane) {
      begin_[plane] = begin;
      for (int t = 0; t < threads; ++t) begin += std::exchange(next_of(t)[plane], begin);
    }
    begin_[size_[0]] = begin;
  }

  void lay_splines(const Share& share, int* next) {
    for (int c = share.begin; c < share.end; ++c) {
      place_[c] = next[point_[c][0]]++;
      atoms_[place_[c]] = {point_[c], charged_[c].atom, charged_[c].charge};
    }
    find_splines(order_, {above_.data() + share.begin, place_.data() + share.begin, share.end - share.begin},
                 splines());
  }

  // All charges of a plane: of the atoms below it, near enough.
  void spread(int plane) {
    double* grid = grid_.plane(plane);
    std::fill_n(grid, std::ptrdiff_t{size_[1]} * grid_.stride(), 0.0);
    for (int k = order_ - 1; k >= 0; --k) {
      const int below = ((plane - k) % size_[0] + size_[0]) % size_[0];
      spread_charges(mesh(), plane, atoms({begin_[below], begin_[below + 1]}), k);
    }
    for (int row = 0; row < size_[1]; ++row, grid += grid_.stride())
      for (int k = order_ - 2; k >= 0; --k)
        grid[k] += grid[size_[2] + k];  // a short row is passed again and again
  }

  void apply_influence(int row) {
    double energy = 0;
    const double* g = influence_of(row);
    for (int k1 = 0; k1 < size_[0]; ++k1) {
      FourierGrid::Complex* z = grid_.row(k1, row);
      for (int k3 = 0; k3 < grid_.half(); ++k3, ++g) {
        energy += share_of(k3) * *g * std::norm(z[k3]);
        z[k3] *= *g;
      }
    }
    energy_of_[row] = energy;
  }

  double share_of(int k3) const { return k3 == 0 || 2 * k3 == size_[2] ? 0.5 : 1; }  // ½, and m₃'s other half

  Eigen::Matrix3d virial_of(int row) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const double inv = square(std::numbers::pi / alpha_);
    const double* g = influence_of(row);
    for (int k1 = 0; k1 < size_[0]; ++k1) {
      const FourierGrid::Complex* z = grid_.row(k1, row);
      const Waves waves = this->waves(k1, row);
      for (int k3 = 0; k3 < grid_.half(); ++k3, ++g) {
        const Vec3 m = waves[k3];
        const double m2 = m.squaredNorm();
        if (m2 == 0) continue;
        const double part = share_of(k3) * *g * std::norm(z[k3]);
        sum.diagonal().array() += part;
        sum -= 2 * part * (1 / m2 + inv) * m * m.transpose();
      }
    }
    return sum;
  }

  // What splines reach beyond a row's end.
  void repeat_row_starts(int plane) {
    double* row = grid_.plane(plane);
    for (int k2 = 0; k2 < size_[1]; ++k2, row += grid_.stride())
      for (int k = 0; k < kMostOrder; ++k) row[size_[2] + k] = row[k];
  }

  void gather(const Share& share, Vectors& f) {
    constexpr int kTogether = 64;
    std::array<Vec3, kTogether> slopes;
    for (int begin = share.begin; begin < share.end; begin += kTogether) {
      const int end = std::min(begin + kTogether, share.end);
      for (int c = begin; c < end; ++c) hwy::Prefetch(f.data() + 3 * std::ptrdiff_t{atoms_[c].atom});
      find_slopes(mesh(), atoms({begin, end}), slopes.data());
      for (int c = begin; c < end; ++c) {
        Vec3& slope = slopes[c - begin];
        for (int d = 0; d < 3; ++d) slope[d] *= size_[d];
        f.col(atoms_[c].atom) -= atoms_[c].charge * box_.reciprocal(slope);
      }
    }
  }

  struct Places {
    int begin, end;
  };
  MeshAtoms atoms(Places p) { return {atoms_.data(), splines(), p.begin, p.end}; }
  MeshSplines splines() { return {weight_.data(), slope_.data()}; }
  MeshGrid mesh() { return {grid_.plane(0), size_, grid_.stride(), order_}; }

  int order_;
  double alpha_;  // [1/nm]
  std::array<int, 3> size_;
  Box box_;
  FourierGrid grid_;
  std::vector<Charged> charged_;
  // As charged_: the point of the grid below, how far above it, 0 … 1, and the place by plane.
  std::vector<std::array<int, 3>> point_;
  std::vector<std::array<double, 3>> above_;
  std::vector<int> place_;
  std::vector<MeshAtom> atoms_;  // by plane, as what follows
  std::vector<double> weight_, slope_;
  std::vector<int> begin_;  // of a plane's, in atoms_
  std::vector<int> next_;   // the same of a thread's, thread by thread
  std::array<std::vector<double>, 3> moduli_;
  std::vector<double> influence_;  // G, row by row, in it plane by plane [1/nm]
  std::vector<double> energy_of_;  // by row, as what follows
  std::vector<Eigen::Matrix3d> virial_of_;
};

PmeMesh::PmeMesh(const Eigen::VectorXd& charge, const PmeParameters& parameters)
    : impl_(std::make_unique<Impl>(charge, parameters)) {}
PmeMesh::~PmeMesh() = default;
PmeMesh::PmeMesh(PmeMesh&&) noexcept = default;
PmeMesh& PmeMesh::operator=(PmeMesh&&) noexcept = default;

void PmeMesh::set_box(const Box& box) {
  impl_->set_box(box);
}
void PmeMesh::add_forces(const Vectors& x, Vectors& f) {
  impl_->add_forces(x, f);
}
double PmeMesh::energy() const {
  return impl_->energy();
}
Eigen::Matrix3d PmeMesh::virial(const Vectors& x) {
  return impl_->virial(x);
}

}  // namespace taut
