function examples(config, options)
% The examples, shortened.
quiet = {'run.duration_s', 5, 'agents.model', 'double_integrator'};
[flown, predicted, t, gains] = lqr_consensus(config, [options {'set', quiet}]);
assert(numel(t) == 501 && t(501) == 5);
assert(max(abs(gains - [0.2 sqrt(0.4)])) < 1e-12);  % the closed form of this plant
assert(max(abs(flown(:) - predicted(:))) < 1e-9);   % m; rounding of 500 steps
assert(max(max(abs(flown(501, :, :)))) < 0.3 * max(max(abs(flown(1, :, :)))));

% Any gain that the search has tried is no better than the one that it returns, and the start is worse.
options = [options {'set', {'run.duration_s', 4}}];
[p_gain, cost] = tune_p_gain(config, options, 12);
[~, start] = tune_p_gain(config, options, 1);
assert(p_gain > 0.045 && cost < start, sprintf('%g: %g, %g', p_gain, cost, start));
end
