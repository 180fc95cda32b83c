#include "files/h5md_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <mutex>

#include "files/h5_objects.hpp"
#include "files/hdf5_driver.hpp"
#include "md/errors.hpp"

namespace taut {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kCommitEvery = std::chrono::seconds(10);
constexpr std::size_t kMostPending = 1 << 26;  // bytes kept in memory, as after a cut

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

// H5MD's species: an enumeration of the atoms' names.
void write_species(const H5Maker& make, const Names& names) {
  const H5Handle type{H5Tenum_create(H5T_NATIVE_INT), H5Tclose};
  std::vector<int> of_kind, species;
  std::vector<std::string> seen;
  for (const AtomKind& kind : names.kinds) {
    int k = 0;
    while (k < static_cast<int>(seen.size()) && seen[k] != kind.atom) ++k;
    if (k == static_cast<int>(seen.size())) {
      seen.push_back(kind.atom);
      H5Tenum_insert(type, kind.atom.c_str(), &k);
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
  Contents(const std::filesystem::path& path, const TrajectorySetup& setup, bool fresh)
      : path_(path),
        medium_{JournaledFile(path, fresh ? DiskFile::kNew : DiskFile::kThere), 0, {}},
        access_(access_to(medium_), H5Pclose),
        file_(fresh ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access_)
                    : H5Fopen(path.c_str(), H5F_ACC_RDWR, access_),
              H5Fclose),
        make_(file_, [this](const std::string& what) { refuse(what); }),
        periodic_(setup.periodic),
        bonds_(setup.sys.bond_count()),
        atoms_(setup.sys.atoms()) {
    if (file_ < 0) refuse("it");
    if (fresh) write_start(setup);
    open_sets();
  }

  ~Contents() {
    for (H5Handle* set : {&step_, &time_, &position_, &velocity_, &force_, &edges_, &tension_, &file_})
      *set = H5Handle();
    if (!medium_.refusal.empty()) return;
    try {
      medium_.file.commit(medium_.end);
    } catch (const OutsideError&) {  // on disk it is as of the commit before
    }
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw OutsideError(medium_.refusal.empty()
                           ? fmt::format("{}: HDF5 cannot read or write {}", path_.string(), what)
                           : medium_.refusal);
  }

  void add(const Frame& frame) {
    make_.append(step_, H5T_NATIVE_LONG, &frame.step);
    make_.append(time_, H5T_NATIVE_DOUBLE, &frame.state.t);
    make_.append(position_, H5T_NATIVE_DOUBLE, frame.state.x.data());
    make_.append(velocity_, H5T_NATIVE_DOUBLE, frame.state.v.data());
    make_.append(force_, H5T_NATIVE_DOUBLE, frame.state.f.data());
    const Eigen::Matrix3d edges = frame.state.box.vectors();  // a row a vector, as HDF5 has it
    if (periodic_) make_.append(edges_, H5T_NATIVE_DOUBLE, edges.data());
    if (bonds_ > 0) make_.append(tension_, H5T_NATIVE_DOUBLE, frame.tension.data());
    if (!medium_.refusal.empty()) refuse("a frame");
    if (!ever_ || Clock::now() - last_ > kCommitEvery || medium_.file.pending() > kMostPending) commit();
  }

  void commit() {
    if (H5Fflush(file_, H5F_SCOPE_GLOBAL) < 0 || !medium_.refusal.empty()) refuse("its tables");
    medium_.file.commit(medium_.end);
    last_ = Clock::now();
    ever_ = true;
  }

  void cut(std::uint64_t frames) {
    if (static_cast<hsize_t>(atoms_) != make_.sizes(position_)[1])
      throw OutsideError(fmt::format("{}: cannot go on: it has another number of atoms", path_.string()));
    if (make_.frames(position_) < frames)
      throw OutsideError(
          fmt::format("{}: cannot go on: it is shorter than it was at the checkpoint", path_.string()));
    for (const H5Handle* set : {&step_, &time_, &position_, &velocity_, &force_, &edges_, &tension_})
      if (*set >= 0) make_.resize(*set, frames);
    commit();
  }

  std::uint64_t frames() const { return make_.frames(position_); }
  bool still_there() const { return medium_.file.still_there(); }

 private:
  // A dataset of vectors in time, which shares its steps and times with the others.
  void write_series(const std::string& group, const H5Maker::Sizes& frame, const char* unit) {
    make_.attribute(make_.growing(group + "/value", H5T_IEEE_F64LE, frame), "unit", std::string(unit));
    for (const char* shared : {"/step", "/time"})
      if (group != kAll + "/position") make_.link(kAll + "/position" + shared, group + shared);
  }

  void write_start(const TrajectorySetup& setup) {
    const hsize_t n = static_cast<hsize_t>(atoms_);
    write_metadata(make_);
    make_.growing(kAll + "/position/step", H5T_STD_I64LE, {});
    make_.attribute(make_.growing(kAll + "/position/time", H5T_IEEE_F64LE, {}), "unit", std::string("ps"));
    write_series(kAll + "/position", {n, 3}, "nm");
    write_series(kAll + "/velocity", {n, 3}, "nm ps-1");
    write_series(kAll + "/force", {n, 3}, kForceUnit);
    const H5Handle box = make_.group(kAll + "/box");
    make_.attribute(box, "dimension", std::vector<int>{3});
    make_.attribute(box, "boundary", std::vector<std::string>(3, periodic_ ? "periodic" : "none"));
    if (periodic_) write_series(kAll + "/box/edges", {3, 3}, "nm");
    if (bonds_ > 0) write_series("/observables/tension", {static_cast<hsize_t>(bonds_)}, kForceUnit);
    make_.attribute(make_.fixed(kAll + "/mass", H5T_NATIVE_DOUBLE, {n}, setup.sys.mass.data()), "unit",
                    std::string("u"));
    write_names(make_, setup.names);
    write_bonds(make_, setup);
  }

  void open_sets() {
    step_ = make_.open(kAll + "/position/step");
    time_ = make_.open(kAll + "/position/time");
    position_ = make_.open(kAll + "/position/value");
    velocity_ = make_.open(kAll + "/velocity/value");
    force_ = make_.open(kAll + "/force/value");
    if (periodic_) edges_ = make_.open(kAll + "/box/edges/value");
    if (bonds_ > 0) tension_ = make_.open("/observables/tension/value");
  }

  std::filesystem::path path_;
  Hdf5Medium medium_;
  H5Handle access_, file_;
  H5Maker make_;
  bool periodic_;
  int bonds_, atoms_;
  H5Handle step_, time_, position_, velocity_, force_, edges_, tension_;
  Clock::time_point last_;
  bool ever_ = false;
};

// HDF5 as Debian builds it knows no threads, and simulations may run side by side.
static std::unique_lock<std::mutex> one_at_a_time() {
  static std::mutex hdf5;
  return std::unique_lock(hdf5);
}

H5mdFile::H5mdFile(const std::filesystem::path& path, const TrajectorySetup& setup, std::uint64_t mark) {
  const auto alone = one_at_a_time();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are told by us, in one line
  contents_ = std::make_unique<Contents>(path, setup, mark == 0);
  if (mark > 0) contents_->cut(mark);
}

H5mdFile::~H5mdFile() {
  const auto alone = one_at_a_time();
  contents_.reset();
}

std::uint64_t H5mdFile::frames(const std::filesystem::path& path, const TrajectorySetup& setup) {
  const auto alone = one_at_a_time();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    return Contents(path, setup, false).frames();
  } catch (const OutsideError&) {
    return 0;
  }
}

void H5mdFile::add(const Frame& frame) {
  const auto alone = one_at_a_time();
  contents_->add(frame);
}

std::uint64_t H5mdFile::mark() {
  const auto alone = one_at_a_time();
  contents_->commit();
  if (!contents_->still_there()) contents_->refuse("it: it was removed while it was written");
  return contents_->frames();
}

}  // namespace taut
