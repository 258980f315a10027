#pragma once

#include <complex>

namespace mascot {

/// dividend / divisor, with the bits that libgcc's division of complex numbers has on x86-64.
std::complex<double> Quotient(std::complex<double> dividend, std::complex<double> divisor);

}  // namespace mascot
