#include "systems/builders/motions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "systems/builders/named_atoms.hpp"

namespace taut {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

void read_atoms(const TomlTable& keys, const Scene& scene, AnchorMotion& motion) {
  const std::size_t words = keys.size(
      "atoms", "the anchors, as [0, \"10-29\", \"W\", -1]: indices from 0 (-1: the last), spans, names");
  if (keys.describing()) return;
  if (words == 0) keys.fail("atoms", "expected the atoms that move, as [0] or [\"W\"]");
  std::set<int> seen;
  for (const AnchorMotion& other : scene.motions) seen.insert(other.atoms.begin(), other.atoms.end());
  for (std::size_t k = 0; k < words; ++k)
    for (const int a : read_named_atoms(keys, "atoms", k, scene)) {
      if (!scene.system.is_anchor(a))
        keys.fail(
            "atoms", k,
            scene.system.is_site(a)
                ? fmt::format("atom {} is a virtual site, which follows its parents: move these", a)
                : fmt::format("atom {} has a mass of {:g} u, and forces move it: make it an anchor (mass "
                              "0), or pull it by a spring (steered)",
                              a, scene.system.mass[a]));
      if (!seen.insert(a).second) keys.fail("atoms", k, fmt::format("atom {} moves already", a));
      motion.atoms.push_back(a);
    }
}

// Throws where rows never move it; notes that they do not in the run, or that its step passes over them.
void judge_rows(const TomlTable& keys, const Rows& rows, Scene& scene) {
  const auto in_one_place = [&](const auto& row) {
    return std::equal(row.begin() + 1, row.end(), rows[0].begin() + 1);
  };
  if (std::ranges::all_of(rows, in_one_place))
    keys.fail("way_nm", "all rows have one place, so that nothing moves: expected rows that differ");
  const double h = scene.run.h(), since = scene.start.t,
               end = since + h * static_cast<double>(scene.run.steps);
  const auto note = [&](const std::string& words) {
    scene.notes.push_back(fmt::format("motion.{}.way_nm: {}", scene.motions.size(), words));
  };
  if (end > since && (rows.back()[0] <= since || rows.front()[0] >= end))
    note(
        fmt::format("nothing moves in this run, from {:g} to {:g} ps: the rows are of {:g} to {:g} ps; shift "
                    "their times, or leave the motion out",
                    since, end, rows.front()[0], rows.back()[0]));
  double gap = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < rows.size(); ++k) gap = std::min(gap, rows[k][0] - rows[k - 1][0]);
  if (gap < 2 * h * (1 - 1e-9))
    note(
        fmt::format("run.dt_fs: {:g} fs does not resolve rows that are {:.2g} fs apart; take {:.2g} fs or "
                    "less, or leave rows out",
                    scene.run.dt_fs, 1000 * gap, 500 * gap));
}

SmoothCourse read_way(const TomlTable& keys, Scene& scene) {
  Rows rows;
  keys.read(
      "way_nm", rows, Columns{4, 4},
      "rows [t, x, y, z]: how far it is from its place at t ps, along the cubic spline that is at rest at "
      "both ends");
  std::vector<SmoothCourse::Point> points;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k > 0 && !(rows[k][0] > rows[k - 1][0]))
      keys.fail(
          "way_nm", k,
          fmt::format("a time of {:g} ps after {:g} ps, expected rising times", rows[k][0], rows[k - 1][0]));
    points.push_back({rows[k][0], Vec3(rows[k].data() + 1)});
  }
  if (keys.has("way_nm") && points.size() < 2) keys.fail("way_nm", "expected two rows [t, x, y, z] or more");
  if (!points.empty()) judge_rows(keys, rows, scene);
  return points.empty() ? SmoothCourse() : SmoothCourse(std::move(points));
}

// A direction that must not be 0; 0 where it is not said.
Vec3 read_direction(const TomlTable& keys, const char* key, const About& about) {
  std::optional<Vec3> read;
  keys.read(key, read, about);
  if (read && !(read->norm() > 0)) keys.fail(key, "expected a vector that is not 0, as [0, 0, 1]");
  return read.value_or(Vec3::Zero());
}

AnchorMotion read_motion(const TomlTable& keys, Scene& scene) {
  AnchorMotion motion;
  read_atoms(keys, scene, motion);
  motion.velocity = read_direction(keys, "velocity_nm_ps", {"constant velocity [x, y, z]", "nm/ps"});
  motion.turn =
      kDegree *
      read_direction(keys, "turn_deg_ps",
                     {"turns by so much about the axis along this vector, by the right hand", "°/ps"});
  std::optional<Vec3> about;
  keys.read("about_nm", about, {"a point on the axis of turn_deg_ps", "nm"});
  motion.shake = read_direction(keys, "shake_nm", {"swings: this vector times sin(2πt/period_ps)", "nm"});
  std::optional<double> period;
  keys.read("period_ps", period, {"period of shake_nm", "ps", kPositive});
  motion.way = read_way(keys, scene);
  keys.require_effect("about_nm", keys.has("turn_deg_ps"), "with turn_deg_ps");
  keys.require_effect("period_ps", keys.has("shake_nm"), "with shake_nm");
  keys.reject_unknown();
  if (keys.describing()) return motion;
  const char* said = nullptr;
  for (const char* key : {"velocity_nm_ps", "turn_deg_ps", "shake_nm", "way_nm"}) {
    if (!keys.has(key)) continue;
    if (said) keys.fail(key, fmt::format("expected either this or {}", said));
    said = key;
  }
  if (!said) keys.fail("atoms", "expected velocity_nm_ps, turn_deg_ps, shake_nm or way_nm beside it");
  if (keys.has("turn_deg_ps") && !about)
    keys.fail("turn_deg_ps", "expected about_nm, a point on the axis, beside it");
  if (keys.has("shake_nm") && !period) keys.fail("shake_nm", "expected period_ps beside it");
  motion.about = about.value_or(Vec3::Zero());
  if (period) motion.shake_rate = 2 * std::numbers::pi / *period;
  return motion;
}

// A way over bonds: how long it is, and where it leads as the atoms stand, through the box, too.
struct Way {
  double length;
  Vec3 to;
};

// The shortest ways over rigid bonds and ropes from an atom to anchors, over atoms with a mass: no anchor can be farther
// from it. By Dijkstra's algorithm.
std::map<int, Way> ways_to_anchors(const System& sys, const Vectors& x,
                                   const std::vector<std::vector<int>>& bonds_at, int from) {
  std::map<int, Way> ways = {{from, {0, Vec3::Zero()}}}, to_anchors;
  std::set<std::pair<double, int>> open = {{0, from}};
  while (!open.empty()) {
    const int at = open.begin()->second;
    open.erase(open.begin());
    const Way gone = ways[at];
    if (at != from && sys.is_anchor(at)) {
      to_anchors[at] = gone;
      continue;
    }
    for (const int k : bonds_at[at]) {
      const RigidBond& bond = sys.bond(k);
      const int to = bond.i == at ? bond.j : bond.i;
      const Way there{gone.length + bond.length, gone.to + (bond.i == at ? 1 : -1) * sys.along(bond, x)};
      const auto [known, fresh] = ways.try_emplace(to, there);
      if (!fresh && known->second.length <= there.length) continue;
      open.erase({known->second.length, to});
      known->second = there;
      open.emplace(there.length, to);
    }
  }
  return to_anchors;
}

// Anchors that move farther apart in the run than the bonds between them reach. Looked at as often as kTimes, and at
// times that no period divides: a shift within each, by the golden ratio (Weyl 1916).
void refuse_what_bonds_cannot_reach(const TomlTable& root, const Scene& scene) {
  constexpr int kTimes = 1000;
  const System& sys = scene.system;
  const Vectors& x = scene.start.x;
  std::vector<std::vector<int>> bonds_at(sys.atoms());
  for (int k = 0; k < sys.all_bonds(); ++k)
    if (sys.side(k) <= 0)
      for (const int a : {sys.bond(k).i, sys.bond(k).j}) bonds_at[a].push_back(k);
  std::map<int, const AnchorMotion*> motion_of;
  for (const AnchorMotion& motion : scene.motions)
    for (const int a : motion.atoms) motion_of[a] = &motion;
  const double since = scene.start.t, length = scene.run.h() * static_cast<double>(scene.run.steps);
  const auto moved = [&](int a, double t) -> Vec3 {
    const auto moves = motion_of.find(a);
    if (moves == motion_of.end()) return Vec3::Zero();
    return moves->second->at(x.col(a), since, t).place - x.col(a);
  };
  for (std::size_t m = 0; m < scene.motions.size(); ++m)
    for (const int a : scene.motions[m].atoms)
      for (const auto& [b, way] : ways_to_anchors(sys, x, bonds_at, a))
        for (int n = 0; n <= kTimes; ++n) {
          const double shifted = n - std::fmod(n * std::numbers::phi, 1.0);
          const double t = since + length * (n < kTimes ? std::max(shifted, 0.0) : n) / kTimes;
          const double apart = (way.to + moved(b, t) - moved(a, t)).norm();
          if (apart <= (1 + 1e-6) * way.length) continue;
          const std::string words = fmt::format(
              "atom {} is {:.6g} nm from anchor {} at {:.4g} ps, and the bonds between them reach {:.6g} "
              "nm: move it less far, or take fewer run.steps",
              a, apart, b, t, way.length);
          if (root.has("motion")) root.section("motion", m).fail("atoms", words);
          throw InputError(
              fmt::format("motion.{}.atoms: {}", m, words));  // of a scene that is read, at another step
        }
}

}  // namespace

void read_motions(const TomlTable& root, Scene& scene) {
  if (root.describing()) read_motion(root.section("motion"), scene);
  const std::size_t count =
      root.size("motion", {"motions that are prescribed to anchors (mass 0), a section [[motion]] each"});
  for (std::size_t k = 0; k < count; ++k)
    scene.motions.push_back(read_motion(root.section("motion", k), scene));
  refuse_what_bonds_cannot_reach(root, scene);
}

std::string in_words(const AnchorMotion& motion, std::size_t number) {
  const auto vector = [](const Vec3& v) { return fmt::format("[{:g}, {:g}, {:g}]", v.x(), v.y(), v.z()); };
  std::string words =
      fmt::format("motion {}: {}", number, counted(static_cast<long>(motion.atoms.size()), "anchor"));
  if (!motion.velocity.isZero(0)) words += fmt::format(" at {} nm/ps", vector(motion.velocity));
  if (!motion.turn.isZero(0))
    words +=
        fmt::format(" turning by {} °/ps about {} nm", vector(motion.turn / kDegree), vector(motion.about));
  if (!motion.shake.isZero(0))
    words += fmt::format(" shaken by {} nm, {:g} ps a period", vector(motion.shake),
                         2 * std::numbers::pi / motion.shake_rate);
  if (!motion.way.empty()) words += " along a way";
  return words;
}

}  // namespace taut
