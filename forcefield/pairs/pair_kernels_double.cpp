#define TAUT_PAIR_REAL double
#include "forcefield/pairs/pair_kernels-inl.hpp"
