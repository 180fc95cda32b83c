#define TAUT_FOURIER_REAL double
#include "forcefield/pme/fourier_kernels-inl.hpp"
