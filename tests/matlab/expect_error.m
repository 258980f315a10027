function expect_error(action, identifier, words)
% Fails unless ACTION throws an error of this IDENTIFIER whose message is, or matches, WORDS.
try
  action();
catch problem
  assert(strcmp(problem.identifier, identifier), [problem.identifier ': ' problem.message]);
  assert(strcmp(problem.message, words) || ~isempty(regexp(problem.message, ['^' words '$'], 'once')), problem.message);
  return
end
error('expected an error: %s', words);
end
