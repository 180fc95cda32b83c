#define TAUT_FOURIER_REAL float
#include "forcefield/pme/fourier_kernels-inl.hpp"
