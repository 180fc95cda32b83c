# Spack's recipe, the file of a package `taut`. The address and the checksum are the public tag's.
from spack.package import *


class Taut(CMakePackage):
    """Molecular dynamics with rigid bonds, and the constraint methods that hold them."""

    license("MIT")
    version("0.2", tag="v0.2")

    variant("python", default=True, description="Build the Python module")
    variant("hdf5", default=True, description="Write and read H5MD files")
    variant("openmm", default=False, description="Compare with OpenMM (taut crosscheck)")

    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("eigen@3.4:")
    depends_on("fmt@9:")
    depends_on("cli11@2.1:")
    depends_on("tomlplusplus@3:")
    depends_on("nlohmann-json@3.10:")
    depends_on("pugixml@1.11:")
    depends_on("highway@1.0:")
    depends_on("hdf5@1.10:", when="+hdf5")
    depends_on("openmm@7.7:", when="+openmm")
    depends_on("python@3.9:", type=("build", "link", "run"), when="+python")
    depends_on("py-pybind11@2.10:", type="build", when="+python")
    depends_on("py-numpy", type=("build", "run"), when="+python")
    conflicts("%gcc@:11", msg="taut is C++20 as GCC 12 knows it")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define("CMAKE_CXX_FLAGS_RELEASE", "-O3 -DNDEBUG"),
            self.define_from_variant("TAUT_WITH_PYTHON", "python"),
            self.define_from_variant("TAUT_WITH_OPENMM", "openmm"),
        ]
