#define TAUT_FOURIER_REAL float
#include "forcefield/ewald/fourier_kernels-inl.hpp"
