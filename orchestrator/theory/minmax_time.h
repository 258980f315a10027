#pragma once

namespace mascot {

// One axis of one edge of min-max time consensus: z = p_c - p_p, w = v_c - v_p, the law switching at
// 2 alpha z + w |w| = 0.

/// Until z = w = 0, after a parent that does not accelerate, for a child that accelerates by
/// `beta` > `alpha` (beta_c, or what the limits leave of it): towards the curve, then along it.
double MinmaxTime(double z_m, double w_m_per_s, double alpha, double beta);
/// The bound for whatever the parent does within its own beta; alpha = beta_c - beta_p.
double MinmaxBound(double z_m, double w_m_per_s, double alpha);

}  // namespace mascot
