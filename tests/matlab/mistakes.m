function mistakes(config, options, program, failing, silent)
% Errors of mascot.Team, by identifier and words.
team = mascot.Team(config, options{:}, 'ports', 1);
expect_error(@() team.step([1 2]), 'mascot:actions', 'expected 3 numbers for 1 ports, got 2');
expect_error(@() team.step([], -1), 'mascot:actions', 'expected an integer from 0 to 1000000 as ticks');
expect_error(@() team.reset([], {'law.p_gian', 1}), 'mascot:server', ...
             'set law.p_gian = 1: law.p_gian: unknown key (did you mean "p_gain"?)');
expect_error(@() team.reset([], {'law.p_gain'}), 'mascot:option', ...
             'expected keys and values, such as {''law.p_gain'', 0.1}');
expect_error(@() team.restore(9), 'mascot:server', 'there is no snapshot 9');
expect_error(@() team.set({'law.p_gain', NaN}), 'mascot:json', 'JSON has no value like this double');
team.step([], 1000);
expect_error(@() team.step(), 'mascot:server', 'the episode is over: expected a reset');
team.close();
expect_error(@() team.step(), 'mascot:connection', 'this team is closed');

expect_error(@() mascot.Team(config, 'portes', 1), 'mascot:option', ...
             'expected one of ports, seed, set, out, engine, orchestrator, timeout_s, with a value, got portes');
expect_error(@() mascot.Team(config, options{:}, 'ports'), 'mascot:option', ...
             'expected one of .*, with a value, got ports');
expect_error(@() mascot.Team('127.0.0.1:9', 'out', 'x'), 'mascot:option', ...
             ['out, engine and orchestrator are for a server that is started, and 127.0.0.1:9 is one that runs']);
expect_error(@() mascot.Team('127.0.0.1:1'), 'mascot:connection', 'cannot connect to 127.0.0.1:1: .*');
expect_error(@() mascot.Team(config, options{:}, 'ports', 9), 'mascot:start', ...
             '.*/orchestrator ended: error: ports: expected agents of the team, from 1 to 3, got 9');
expect_error(@() mascot.Team(config, 'orchestrator', fullfile(program, 'no program')), 'mascot:start', ...
             '.*no program ended: .*');
expect_error(@() mascot.Team(config, 'orchestrator', silent, 'timeout_s', 3), 'mascot:start', ...
             [silent ' says no address within 3 s: not yet']);

team = mascot.Team(failing, options{:});
expect_error(@() team.step([], 10), 'mascot:server', '.*ZeroDivisionError.*');
assert(team.over && team.failed && team.tick == 3 && ~isempty(strfind(team.failure, 'ZeroDivisionError')));
team.reset();
assert(~team.failed && isempty(team.failure));
team.close();

expect_error(@() mascot.read_run(program), 'mascot:file', ...
             [program ': expected states.npz or states.mat: `orchestrator export --format npz` writes it']);
end
