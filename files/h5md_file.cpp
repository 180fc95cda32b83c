#include "files/h5md_file.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdlib>

#include "base/errors.hpp"
#include "files/h5_objects.hpp"
#include "files/hdf5_driver.hpp"

namespace taut {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kCommitEvery = std::chrono::seconds(10);
constexpr std::size_t kMostPending = 1 << 26;  // most bytes kept in memory, e.g. after truncation

const std::string kAll = "/particles/all";
constexpr const char* kForceUnit = "kJ mol-1 nm-1";

void write_metadata(const H5Maker& make) {
  make.attribute(make.group("/h5md"), "version", std::vector<int>{1, 1});
  const char* user = std::getenv("USER");
  make.attribute(make.group("/h5md/author"), "name", std::string(user != nullptr ? user : "N/A"));
  const H5Handle creator = make.group("/h5md/creator");
  make.attribute(creator, "name", std::string("taut"));
  make.attribute(creator, "version", std::string(TAUT_VERSION));
  make.attribute(make.group("/h5md/modules/units"), "version", std::vector<int>{1, 0});
}

// Returns the type of H5MD's species: an enumeration of the atoms' names.
void write_species(const H5Maker& make, const Names& names) {
  const H5Handle type{H5Tenum_create(H5T_NATIVE_INT), H5Tclose};
  std::vector<int> of_kind, species;
  std::vector<std::string> seen;
  for (const AtomKind& kind : names.kinds) {
    int k = 0;
    while (k < static_cast<int>(seen.size()) && seen[k] != kind.atom) ++k;
    if (k == static_cast<int>(seen.size())) {
      seen.push_back(kind.atom);
      accepted(H5Tenum_insert(type, kind.atom.c_str(), &k));
    }
    of_kind.push_back(k);
  }
  for (const int kind : names.kind) species.push_back(of_kind[kind]);
  make.fixed(kAll + "/species", type, {species.size()}, species.data());
}

void write_names(const H5Maker& make, const Names& names) {
  write_species(make, names);
  const std::string topology = "/parameters/topology/";
  make.fixed(topology + "kind", H5T_NATIVE_INT, {names.kind.size()}, names.kind.data());
  make.fixed(topology + "residue", H5T_NATIVE_INT, {names.residue.size()}, names.residue.data());
  std::vector<std::string> atoms, residues, elements;
  for (const AtomKind& kind : names.kinds) {
    atoms.push_back(kind.atom);
    residues.push_back(kind.residue);
    elements.push_back(kind.element);
  }
  make.words(topology + "atom_name", atoms);
  make.words(topology + "residue_name", residues);
  make.words(topology + "element", elements);
}

void write_bonds(const H5Maker& make, const TrajectorySetup& setup) {
  std::vector<int> atoms;
  for (const RigidBond& bond : setup.sys.bonds) atoms.insert(atoms.end(), {bond.i, bond.j});
  for (const auto& [i, j] : setup.further_bonds) atoms.insert(atoms.end(), {i, j});
  if (atoms.empty()) return;
  const H5Handle bonds =
      make.fixed("/connectivity/bonds", H5T_NATIVE_INT, {atoms.size() / 2, 2}, atoms.data());
  make.reference(bonds, "particles_group", kAll);
}

}  // namespace

struct H5mdFile::Contents {
  Contents(const std::filesystem::path& path, const TrajectorySetup& setup, DiskFile::Opening opening)
      : medium_{JournaledFile(path, opening), 0, {}, {}},
        periodic_(setup.periodic),
        bonds_(setup.sys.bond_count()),
        atoms_(setup.sys.atoms()) {
    attempt([&] {
      const H5Handle access = access_to(medium_);
      const bool fresh = opening == DiskFile::kNew;
      const unsigned rights = opening == DiskFile::kRead ? H5F_ACC_RDONLY : H5F_ACC_RDWR;
      file_ = {fresh ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                     : H5Fopen(path.c_str(), rights, access),
               H5Fclose};
      if (fresh) write_start(setup);
      open_sets();
      changed_ = fresh;
    });
  }

  ~Contents() {
    for (H5Handle* set : sets()) *set = H5Handle();
    try {
      file_.close();
      if (changed_ && medium_.refusal.empty()) medium_.commit();
    } catch (const std::runtime_error&) {  // the file on disk stays as of the previous commit
    }
  }

  // Calls `deed`. An error of HDF5 or the disk is thrown with this file's name.
  template <class Deed>
  void attempt(const Deed& deed) {
    try {
      deed();
    } catch (const Hdf5Refusal& e) {
      if (medium_.refusal.empty())
        throw OutsideError(fmt::format("{}: {}", medium_.file.path().string(), e.what()));
    }
    if (!medium_.refusal.empty()) throw OutsideError(medium_.refusal);
  }

  void add(const Frame& frame) {
    const H5Maker make(file_);
    changed_ = true;
    make.append(step_, H5T_NATIVE_LONG, &frame.step);
    make.append(time_, H5T_NATIVE_DOUBLE, &frame.state.t);
    make.append(position_, H5T_NATIVE_DOUBLE, frame.state.x.data());
    make.append(velocity_, H5T_NATIVE_DOUBLE, frame.state.v.data());
    make.append(force_, H5T_NATIVE_DOUBLE, frame.state.f.data());
    const Eigen::Matrix3d edges = frame.state.box.vectors();  // one row per vector, as in HDF5
    if (periodic_) make.append(edges_, H5T_NATIVE_DOUBLE, edges.data());
    if (bonds_ > 0) make.append(tension_, H5T_NATIVE_DOUBLE, frame.tension.data());
    if (!ever_ || Clock::now() - last_ > kCommitEvery || medium_.file.pending() > kMostPending) commit();
  }

  void commit() {
    accepted(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    if (!medium_.refusal.empty()) return;
    medium_.commit();
    last_ = Clock::now();
    ever_ = true;
  }

  void cut(std::uint64_t frames) {
    const H5Maker make(file_);
    const H5Maker::Sizes sizes = make.sizes(position_);
    if (sizes.size() != 3 || sizes[1] != static_cast<hsize_t>(atoms_))
      refuse("it has another number of atoms");
    for (const H5Handle* set : sets())
      if (*set >= 0 && make.frames(*set) < frames) refuse("it is shorter than it was at the checkpoint");
    changed_ = true;
    for (const H5Handle* set : sets())
      if (*set >= 0) make.resize(*set, frames);
    commit();
  }

  std::uint64_t frames() const { return H5Maker(file_).frames(position_); }
  bool still_there() const { return medium_.file.still_there(); }
  [[noreturn]] void refuse(const char* why) const {
    throw OutsideError(fmt::format("{}: cannot go on: {}", medium_.file.path().string(), why));
  }

 private:
  // Makes a time-dependent dataset of vectors, which shares its steps and times with the others.
  void write_series(const std::string& group, const H5Maker::Sizes& frame, const char* unit) const {
    const H5Maker make(file_);
    make.attribute(make.growing(group + "/value", H5T_IEEE_F64LE, frame), "unit", std::string(unit));
    for (const char* shared : {"/step", "/time"})
      if (group != kAll + "/position") make.link(kAll + "/position" + shared, group + shared);
  }

  void write_start(const TrajectorySetup& setup) {
    const H5Maker make(file_);
    const hsize_t n = static_cast<hsize_t>(atoms_);
    write_metadata(make);
    make.growing(kAll + "/position/step", H5T_STD_I64LE, {});
    make.attribute(make.growing(kAll + "/position/time", H5T_IEEE_F64LE, {}), "unit", std::string("ps"));
    write_series(kAll + "/position", {n, 3}, "nm");
    write_series(kAll + "/velocity", {n, 3}, "nm ps-1");
    write_series(kAll + "/force", {n, 3}, kForceUnit);
    const H5Handle box = make.group(kAll + "/box");
    make.attribute(box, "dimension", std::vector<int>{3});
    make.attribute(box, "boundary", std::vector<std::string>(3, periodic_ ? "periodic" : "none"));
    if (periodic_) write_series(kAll + "/box/edges", {3, 3}, "nm");
    if (bonds_ > 0) write_series("/observables/tension", {static_cast<hsize_t>(bonds_)}, kForceUnit);
    make.attribute(make.fixed(kAll + "/mass", H5T_NATIVE_DOUBLE, {n}, setup.sys.mass.data()), "unit",
                   std::string("u"));
    write_names(make, setup.names);
    write_bonds(make, setup);
  }

  void open_sets() {
    const H5Maker make(file_);
    step_ = make.open(kAll + "/position/step");
    time_ = make.open(kAll + "/position/time");
    position_ = make.open(kAll + "/position/value");
    velocity_ = make.open(kAll + "/velocity/value");
    force_ = make.open(kAll + "/force/value");
    if (periodic_) edges_ = make.open(kAll + "/box/edges/value");
    if (bonds_ > 0) tension_ = make.open("/observables/tension/value");
  }

  std::array<H5Handle*, 7> sets() {
    return {&step_, &time_, &position_, &velocity_, &force_, &edges_, &tension_};
  }

  Hdf5Medium medium_;
  H5Handle file_;
  bool periodic_;
  int bonds_, atoms_;
  H5Handle step_, time_, position_, velocity_, force_, edges_, tension_;
  Clock::time_point last_;
  bool ever_ = false;     // whether it was ever committed
  bool changed_ = false;  // whether it was changed since it was opened
};

bool built_with_hdf5() {
  return true;
}

H5mdFile::H5mdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark) {
  with_hdf5([&] {
    auto contents = std::make_unique<Contents>(path, setup, mark == 0 ? DiskFile::kNew : DiskFile::kThere);
    if (mark > 0) contents->attempt([&] { contents->cut(mark); });
    contents_ = std::move(contents);
  });
}

H5mdFile::~H5mdFile() {
  with_hdf5([&] { contents_.reset(); });
}

std::uint64_t H5mdFile::frames(const std::filesystem::path& path, const TrajectorySetup& setup) {
  std::uint64_t frames = 0;
  with_hdf5([&] {
    try {
      Contents contents(path, setup, DiskFile::kRead);
      contents.attempt([&] { frames = contents.frames(); });
    } catch (const OutsideError&) {
    }
  });
  return frames;
}

void H5mdFile::add(const Frame& frame) {
  with_hdf5([&] { contents_->attempt([&] { contents_->add(frame); }); });
}

std::uint64_t H5mdFile::mark() {
  std::uint64_t frames = 0;
  with_hdf5([&] {
    contents_->attempt([&] {
      contents_->commit();
      frames = contents_->frames();
    });
    if (!contents_->still_there()) contents_->refuse("it was removed while it was written");
  });
  return frames;
}

}  // namespace taut
