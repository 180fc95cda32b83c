#define TAUT_MESH_REAL float
#include "forcefield/ewald/mesh_kernels-inl.hpp"
