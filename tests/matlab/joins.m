function joins(address, silent, closing)
% Joins a server that runs; and what is no server.
team = mascot.Team(address, 'ports', 2, 'seed', 5, 'set', {'law.p_gain', 0.2});
assert(isequal(team.about.ports.agent, 2));
other = mascot.json_text({team.about.keys(strcmp({team.about.keys.key}, 'law.p_gain')).value});
assert(strcmp(other, '[0.20000000000000001]'), other);
team.step([0 1 0], 3);
assert(team.tick == 3);
team.close();
again = mascot.Team(address);  % the server goes on without the first client
assert(again.tick == 3);
again.goto(1, [9 9 1]);
again.step();
again.close();
expect_error(@() mascot.Team(silent, 'timeout_s', 0.2), 'mascot:connection', ...
             'no answer of the server: it said nothing for 0.2 s');
expect_error(@() mascot.Team(closing), 'mascot:connection', 'no answer of the server: .*[Cc]onnection.*');
end
