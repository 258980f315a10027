function text = json_text(value)
% json_text(VALUE) writes VALUE as JSON. Numbers read back as the same double, which jsonencode does not promise.
%
%   char, string     text                       scalar number    a number; it must be finite
%   logical          true, false                vector           a list
%   struct, containers.Map    an object         matrix           a list of its rows
%   cell, array of structs    a list
%
% A list with one number is a cell: {3}.
if isstruct(value) && isscalar(value)
  text = object_of(fieldnames(value), struct2cell(value));
elseif isa(value, 'containers.Map')
  text = object_of(keys(value), values(value));
elseif isstruct(value)
  text = list_of(num2cell(value));
elseif iscell(value)
  text = list_of(value);
elseif ischar(value) || isa(value, 'string')
  text = quoted(char(value));
elseif isscalar(value) && islogical(value)
  names = {'false', 'true'};
  text = names{1 + value};
elseif isscalar(value) && isnumeric(value) && isreal(value) && isfinite(value)
  text = sprintf('%.17g', value);
  if value == 0 && 1 / double(value) < 0, text = '-0.0'; end  % -0 alone would be the integer
elseif (isnumeric(value) || islogical(value)) && ~isscalar(value)
  if isvector(value) || isempty(value)
    text = list_of(num2cell(value));
  else
    text = list_of(num2cell(value, 2));
  end
else
  error('mascot:json', 'JSON has no value like this %s', class(value));
end
end

function text = list_of(items)
text = ['[' strjoin(cellfun(@mascot.json_text, items(:).', 'UniformOutput', false), ',') ']'];
end

function text = object_of(names, items)
pairs = cellfun(@(name, item) [quoted(name) ':' mascot.json_text(item)], names(:).', items(:).', ...
                'UniformOutput', false);
text = ['{' strjoin(pairs, ',') '}'];
end

function text = quoted(text)
text = strrep(strrep(text, '\', '\\'), '"', '\"');
for control = char(0:31)
  text = strrep(text, control, sprintf('\\u%04x', double(control)));
end
text = ['"' text '"'];
end
