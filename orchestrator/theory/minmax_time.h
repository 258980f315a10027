#pragma once

namespace mascot {

// One axis of one edge of min-max time consensus (Mulla et al. 2017): z = p_c - p_p, w = v_c - v_p of child c and
// parent p. The law switches at 2 alpha z + w |w| = 0. alpha and beta are accelerations (m/s^2).

/// Time (s) until z = w = 0, if the parent does not accelerate and the child accelerates with `beta` > `alpha` (beta_c,
/// or the acceleration limit if that is smaller): first towards the switching curve, then along it.
double MinmaxTime(double z_m, double w_m_per_s, double alpha, double beta);
/// Upper bound of that time (s) for any motion of the parent within its own beta; alpha = beta_c - beta_p.
double MinmaxBound(double z_m, double w_m_per_s, double alpha);

}  // namespace mascot
