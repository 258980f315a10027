function installed(config)
% A team without the option orchestrator.
team = mascot.Team(config);
team.step([], 5);
assert(team.tick == 5);
delete(team);
end
