#define TAUT_MESH_REAL double
#include "forcefield/ewald/mesh_kernels-inl.hpp"
