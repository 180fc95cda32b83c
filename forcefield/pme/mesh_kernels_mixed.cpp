#define TAUT_MESH_REAL float
#include "forcefield/pme/mesh_kernels-inl.hpp"
