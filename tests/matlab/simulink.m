function simulink(config, options, out)
% The S-function between two stub blocks of Simulink, beside teams that are stepped without it.
gains = -[0.1 0.3];
first = StubBlock(2.0001, {config, [1 2], 3, options});
second = StubBlock(3.0001, {config, [], [], [options {'out', out, 'set', {'law.p_gain', 0.1}}]});
msfun_team(first);
msfun_team(second);
assert(isequal(first.SampleTimes, [0.01 0]) && first.InputPort(1).Dimensions == 6 && second.NumInputPorts == 0);
assert(strcmp(first.SimStateCompliance, 'DisallowSimState'));
beside = mascot.Team(config, 'ports', [1 2], 'seed', 3, options{:});
quiet = mascot.Team(config, options{:}, 'set', {'law.p_gain', 0.1});
first.begin();
second.begin();
for k = 1:60  % ten more than the episode has
  values = first.outputs();
  assert(isequal(values, {beside.p, beside.v, beside.attitude, beside.w, double(beside.over)}));
  others = second.outputs();
  assert(isequal(others{1}, quiet.p));
  wanted = gains(1) * values{1}(1:2, :) + gains(2) * values{2}(1:2, :);
  first.update(reshape(wanted.', 1, []));
  second.update([]);
  if ~beside.over
    beside.step(wanted);
    quiet.step();
  end
end
assert(beside.over && values{5} == 1);
first.methods_.InitializeConditions(first);  % as in a subsystem that is enabled again
again = first.outputs();
beside.reset();
assert(isequal(again{1}, beside.p) && again{5} == 0);
first.terminate();
second.terminate();
first.terminate();  % no mistake: Simulink does so after an error in Start
run = mascot.read_run(fullfile(out, '1'));
assert(isequal(squeeze(run.position(51, :, :)), quiet.p) && ~isfolder(fullfile(out, '2')));
beside.close();
quiet.close();
expect_error(@() msfun_team(StubBlock(4, {config, 9, [], options})), 'mascot:start', '.*from 1 to 3, got 9');
end
