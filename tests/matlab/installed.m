function installed(config)
% A team without the option orchestrator, in a folder whose name has a quote.
folder = [tempname() ' it''s'];
mkdir(folder);
cleanup = onCleanup(@() rmdir(folder, 's'));
copy = fullfile(folder, 'a team.toml');
copyfile(config, copy);
team = mascot.Team(copy);
team.step([], 5);
assert(team.tick == 5);
delete(team);
end
