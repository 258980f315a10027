// The functions of <cmath> whose last bit depends on the processor in glibc (it computes with FMA where there is one),
// here by SLEEF's deterministic functions, which give the same bits on every x86-64 and aarch64 processor. Their errors
// are below 1 unit in the last place (erfc: 1.5).
//
// They are defined under the names of libm, and the programs export them: the dynamic linker then takes them for
// Bullet, Python, NumPy and plug-in laws too, and no code can call the others by mistake. SLEEF sets no errno, and
// neither do these. Not here: what is exact or correctly rounded anyway (sqrt, fmod, floor, ...), long double, complex
// functions.
//
// SLEEF computes some functions faster for two equal numbers at once than for one, and to the same bits. These
// functions are taken from base/lanes.h.
#include <sleef.h>

#include "base/lanes.h"

extern "C" {

double sin(double x) noexcept { return mascot::Sin(mascot::InEach(x))[0]; }
double cos(double x) noexcept { return mascot::Cos(mascot::InEach(x))[0]; }
double tan(double x) noexcept { return Sleef_cinz_tand1_u10purec(x); }
double asin(double x) noexcept { return Sleef_cinz_asind1_u10purec(x); }
double acos(double x) noexcept { return Sleef_cinz_acosd1_u10purec(x); }
double atan(double x) noexcept { return Sleef_cinz_atand1_u10purec(x); }
double sinh(double x) noexcept { return Sleef_cinz_sinhd1_u10purec(x); }
double cosh(double x) noexcept { return Sleef_cinz_coshd1_u10purec(x); }
double tanh(double x) noexcept { return Sleef_cinz_tanhd1_u10purec(x); }
double asinh(double x) noexcept { return Sleef_cinz_asinhd1_u10purec(x); }
double acosh(double x) noexcept { return Sleef_cinz_acoshd1_u10purec(x); }
double atanh(double x) noexcept { return Sleef_cinz_atanhd1_u10purec(x); }
double exp(double x) noexcept { return Sleef_cinz_expd1_u10purec(x); }
double exp2(double x) noexcept { return Sleef_cinz_exp2d1_u10purec(x); }
double exp10(double x) noexcept { return Sleef_cinz_exp10d1_u10purec(x); }
double expm1(double x) noexcept { return Sleef_cinz_expm1d1_u10purec(x); }
double log(double x) noexcept { return Sleef_cinz_logd1_u10purec(x); }
double log2(double x) noexcept { return Sleef_cinz_log2d1_u10purec(x); }
double log10(double x) noexcept { return Sleef_cinz_log10d1_u10purec(x); }
double log1p(double x) noexcept { return Sleef_cinz_log1pd1_u10purec(x); }
double cbrt(double x) noexcept { return Sleef_cinz_cbrtd1_u10purec(x); }
double erf(double x) noexcept { return Sleef_cinz_erfd1_u10purec(x); }
double erfc(double x) noexcept { return Sleef_cinz_erfcd1_u15purec(x); }
double tgamma(double x) noexcept { return Sleef_cinz_tgammad1_u10purec(x); }
double atan2(double y, double x) noexcept { return mascot::Atan2(mascot::InEach(y), mascot::InEach(x))[0]; }
double pow(double x, double y) noexcept { return Sleef_cinz_powd1_u10purec(x, y); }
double hypot(double x, double y) noexcept { return Sleef_cinz_hypotd1_u05purec(x, y); }

/// GNU: g++ calls it where code takes both.
void sincos(double x, double* sine, double* cosine) noexcept {
  *sine = sin(x);
  *cosine = cos(x);
}

float sinf(float x) noexcept { return Sleef_cinz_sinf1_u10purec(x); }
float cosf(float x) noexcept { return Sleef_cinz_cosf1_u10purec(x); }
float tanf(float x) noexcept { return Sleef_cinz_tanf1_u10purec(x); }
float asinf(float x) noexcept { return Sleef_cinz_asinf1_u10purec(x); }
float acosf(float x) noexcept { return Sleef_cinz_acosf1_u10purec(x); }
float atanf(float x) noexcept { return Sleef_cinz_atanf1_u10purec(x); }
float sinhf(float x) noexcept { return Sleef_cinz_sinhf1_u10purec(x); }
float coshf(float x) noexcept { return Sleef_cinz_coshf1_u10purec(x); }
float tanhf(float x) noexcept { return Sleef_cinz_tanhf1_u10purec(x); }
float asinhf(float x) noexcept { return Sleef_cinz_asinhf1_u10purec(x); }
float acoshf(float x) noexcept { return Sleef_cinz_acoshf1_u10purec(x); }
float atanhf(float x) noexcept { return Sleef_cinz_atanhf1_u10purec(x); }
float expf(float x) noexcept { return Sleef_cinz_expf1_u10purec(x); }
float exp2f(float x) noexcept { return Sleef_cinz_exp2f1_u10purec(x); }
float exp10f(float x) noexcept { return Sleef_cinz_exp10f1_u10purec(x); }
float expm1f(float x) noexcept { return Sleef_cinz_expm1f1_u10purec(x); }
float logf(float x) noexcept { return Sleef_cinz_logf1_u10purec(x); }
float log2f(float x) noexcept { return Sleef_cinz_log2f1_u10purec(x); }
float log10f(float x) noexcept { return Sleef_cinz_log10f1_u10purec(x); }
float log1pf(float x) noexcept { return Sleef_cinz_log1pf1_u10purec(x); }
float cbrtf(float x) noexcept { return Sleef_cinz_cbrtf1_u10purec(x); }
float erff(float x) noexcept { return Sleef_cinz_erff1_u10purec(x); }
float erfcf(float x) noexcept { return Sleef_cinz_erfcf1_u15purec(x); }
float tgammaf(float x) noexcept { return Sleef_cinz_tgammaf1_u10purec(x); }
float atan2f(float y, float x) noexcept { return Sleef_cinz_atan2f1_u10purec(y, x); }
float powf(float x, float y) noexcept { return Sleef_cinz_powf1_u10purec(x, y); }
float hypotf(float x, float y) noexcept { return Sleef_cinz_hypotf1_u05purec(x, y); }
void sincosf(float x, float* sine, float* cosine) noexcept {
  *sine = sinf(x);
  *cosine = cosf(x);
}

}  // extern "C"
