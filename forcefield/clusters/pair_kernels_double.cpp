#define TAUT_PAIR_REAL double
#include "forcefield/clusters/pair_kernels-inl.hpp"
