function steps(config, options, folder)
% Flies a team as matlab_test.py does, and writes each state to FOLDER/states, and other answers to FOLDER/answers.
states = fopen(fullfile(folder, 'states'), 'w');
answers = fopen(fullfile(folder, 'answers'), 'w');
team = mascot.Team(config, options{:}, 'ports', [1 2], 'seed', 3, 'set', {'run.on_agent_loss', 'drop'}, ...
                   'out', fullfile(folder, 'episodes'));
note = @() write_state(states, team);
answer = @(value) fprintf(answers, '%s\n', mascot.json_text(value));
answer(team.about.name);
answer({team.about.ports.agent});
answer(team.about.rate_hz);
note();
team.step([1/3 -0.1 0; 0 0.2 1e-3], 3); note();
team.step(); note();
team.step([], 2); note();
kept = team.snapshot();
text = team.snapshot('text');
team.step([0.5 0 0 0 0.5 0]); note();
team.restore(kept); note();
team.step([], 5); note();
team.restore(text); note();
team.forget(kept);
answer(team.set({'law.p_gain', 1/7}, 3)); note();
team.step([], 4); note();
answer(team.set({'law.p_gain', 0.3, 'law.beta', 0.7}));
answer(team.event(struct('fault', struct('agent', 2, 'kind', 'kill'))));
team.step([], 4); note();
team.reset(4, {'law.p_gain', 0.1, 'graph.topology', 'ring'}); note();
team.step([], 7); note();
team.reset(4, {}, 3); note();
answer({team.about.ports.agent});
team.step([0.1 0.2 0.3], 1000); note();
team.look();
assert(team.over && ~team.failed && isempty(team.failure));
answer(team.recording);
team.close();
team.close();  % no mistake
% The recording of the last episode ends where the team was.
run = mascot.read_run(team.recording);
rows = numel(run.t);
assert(isequal(squeeze(run.position(rows, :, :)), team.p) && run.t(rows) == team.t);
end
