#define TAUT_PAIR_REAL float
#include "forcefield/clusters/pair_kernels-inl.hpp"
