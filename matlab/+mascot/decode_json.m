function value = decode_json(text)
% decode_json(TEXT) is jsondecode(TEXT), with each number as the double that is nearest to its digits. Octave's
% jsondecode may be off in the last bit.
[tokens, between] = regexp(text, '"(?>(?:[^"\\]|\\.)*)"|-?\d[-+.eE\d]*', 'match', 'split');
is_number = cellfun(@(token) token(1) ~= '"', tokens);
numbers = sscanf(strjoin(tokens(is_number), ' '), '%f').';
tokens(is_number) = arrayfun(@(k) sprintf('%d', k), 1:numel(numbers), 'UniformOutput', false);  % exact: integers
pieces = [between; [tokens, {''}]];
value = numbered(jsondecode([pieces{:}]), numbers);
end

function value = numbered(value, numbers)
% Puts numbers in the places of their indices. NaN stands for null.
if isstruct(value)
  for name = fieldnames(value).'
    for k = 1:numel(value)
      value(k).(name{1}) = numbered(value(k).(name{1}), numbers);
    end
  end
elseif iscell(value)
  value = cellfun(@(item) numbered(item, numbers), value, 'UniformOutput', false);
elseif isnumeric(value)
  is_index = ~isnan(value);
  value(is_index) = numbers(value(is_index));
end
end
