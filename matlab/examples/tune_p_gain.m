function [p_gain, cost] = tune_p_gain(config, options, evaluations)
% tune_p_gain(CONFIG, OPTIONS, EVALUATIONS) looks for the law.p_gain with which a team agrees best, by fminsearch:
% each evaluation is an episode. The cost is the mean square of the disagreement (m^2) over the episode, at every
% tenth tick.
%
%   p_gain = tune_p_gain('configs/leaderless.toml');
%
% OPTIONS: of mascot.Team, for example {'set', {'run.duration_s', 10}}. EVALUATIONS: how many at most; default: 40.
if nargin < 2, options = {}; end
if nargin < 3, evaluations = 40; end
team = mascot.Team(config, options{:});
closing = onCleanup(@() team.close());
keys = team.about.keys;
start = keys(strcmp({keys.key}, 'law.p_gain')).value;
limits = optimset('MaxFunEvals', evaluations, 'TolX', 1e-3, 'TolFun', 1e-6, 'Display', 'off');
% Of the logarithm, so that every value that is tried is a positive gain.
[best, cost] = fminsearch(@(log_gain) cost_of(team, exp(log_gain)), log(start), limits);
p_gain = exp(best);
end

function cost = cost_of(team, p_gain)
team.reset([], {'law.p_gain', p_gain});
total = team.figures.disagreement_m^2;
count = 1;
while ~team.over
  team.step([], 10);
  total = total + team.figures.disagreement_m^2;
  count = count + 1;
end
cost = total / count;
end
