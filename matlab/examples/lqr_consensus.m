function [flown, predicted, t, gains] = lqr_consensus(config, options, weights)
% lqr_consensus(CONFIG, OPTIONS, WEIGHTS) designs a linear-quadratic consensus of double integrators in x and y,
% without a toolbox, and flies it: all agents of CONFIG take actions, computed here, one each tick.
%
%   options = {'set', {'agents.model', 'double_integrator'}, 'engine', 'dds'};
%   [flown, predicted] = lqr_consensus('configs/leaderless.toml', options);
%
% With e = p - mean(p) and its rate e', the cost  int q_p |e|^2 + q_v |e'|^2 + r |u|^2 dt, WEIGHTS = [q_p q_v r], asks
% the same of each agent and axis:
%   u_i = -k_p (p_i - mean(p)) - k_v (v_i - mean(v)),
% where [k_p k_v] is the gain of one double integrator, by the Riccati equation. Its solution is X = U2 / U1 of the
% stable eigenvectors [U1; U2] of the Hamiltonian matrix. For this plant, k_p = sqrt(q_p / r) and k_v = sqrt(q_v / r +
% 2 k_p).
%
% An action holds for a period h, and the physics moves such a body as the equations of motion do, so
%   x(k + 1) = (F - G [k_p k_v]) x(k),  F = [1 h; 0 1],  G = [h^2 / 2; h],
% which is the closed form that is returned beside the flight. It holds while no limit cuts an action
% (control.max_acceleration_m_per_s2) and no agent touches another.
%
% FLOWN, PREDICTED: (ticks + 1) x agents x 2, p - mean(p) in x and y (m); T: times (s); GAINS: [k_p k_v] (1/s^2, 1/s).
if nargin < 2, options = {}; end
if nargin < 3, weights = [0.04 0 1]; end
gains = gains_of(weights);

team = mascot.Team(config, options{:});
closing = onCleanup(@() team.close());
agents = team.about.agents;
team.reset([], [], 1:agents);
ticks = team.about.ticks;
h = 1 / team.about.rate_hz;
closed = [1 h; 0 1] - [h^2 / 2; h] * gains;
around_mean = eye(agents) - ones(agents) / agents;

% A column for each agent and axis.
x = [reshape(around_mean * team.p(:, 1:2), 1, []); reshape(around_mean * team.v(:, 1:2), 1, [])];
[flown, predicted] = deal(zeros(ticks + 1, agents, 2));
for k = 1:ticks + 1
  flown(k, :, :) = reshape(around_mean * team.p(:, 1:2), 1, agents, 2);
  predicted(k, :, :) = reshape(x(1, :), 1, agents, 2);
  if k > ticks, break, end
  team.step(-around_mean * (gains(1) * team.p + gains(2) * team.v));
  x = closed * x;
end
t = (0:ticks).' * h;
end

function gains = gains_of(weights)
A = [0 1; 0 0];
B = [0; 1];
Q = diag(weights(1:2));
hamiltonian = [A, -B * B.' / weights(3); -Q, -A.'];
[vectors, values] = eig(hamiltonian);
stable = vectors(:, real(diag(values)) < 0);
X = real(stable(3:4, :) / stable(1:2, :));
gains = B.' * X / weights(3);
end
