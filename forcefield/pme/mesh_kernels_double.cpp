#define TAUT_MESH_REAL double
#include "forcefield/pme/mesh_kernels-inl.hpp"
