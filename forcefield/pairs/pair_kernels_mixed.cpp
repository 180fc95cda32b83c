#define TAUT_PAIR_REAL float
#include "forcefield/pairs/pair_kernels-inl.hpp"
