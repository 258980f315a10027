function run = read_run(folder)
% read_run(FOLDER) reads a recorded run from the files of its folder. It needs no program of MASCOT.
%
%   run = mascot.read_run('runs/leaderless/2026-01-31T10-00-00');
%   plot(run.t, squeeze(run.position(:, 3, :)));     % agent 3
%
% Fields: the arrays of states.npz (docs/recording.md): t (rows x 1), id (1 x agents), position, velocity,
% angular_velocity, acceleration_command (rows x agents x 3), orientation (rows x agents x 4: w, x, y, z), actuator
% (rows x agents x 4), flags (rows x agents); where there is no states.npz, those of states.mat. Numbers have the bits
% of the recording. Also:
%   events     struct array, a line of events.csv each: t_s, until_s, what, count, agent, with, detail
%   summary    summary.json
%   figures    struct array: the numbers of the summary, with name ('consensus.settling_time_s') and value
%   config     the experiment with all defaults, as TOML
% Error mascot:file: what is missing.
folder = char(folder);
in = @(name) fullfile(folder, name);
if exist(in('states.npz'), 'file')
  run = mascot.read_npz(in('states.npz'));
  run.id = double(run.id(:).');
elseif exist(in('states.mat'), 'file')
  run = load(in('states.mat'));
else
  error('mascot:file', '%s: expected states.npz or states.mat: `orchestrator export --format npz` writes it', folder);
end
run.events = events_of(text_of(in('events.csv')));
run.summary = mascot.decode_json(text_of(in('summary.json')));
[names, values] = numbers_of(run.summary, '');
run.figures = struct('name', names, 'value', values);
run.config = text_of(in('config.toml'));
end

function text = text_of(path)
id = fopen(path, 'r', 'n', 'UTF-8');
if id < 0, error('mascot:file', 'cannot open %s', path); end
text = fread(id, Inf, 'char=>char').';
fclose(id);
end

function events = events_of(text)
% A table as RFC 4180 has it: a field in quotes may hold commas, ends of lines, and quotes twice.
fields = regexp(text, '("(?>(?:[^"]|"")*)"|[^,\r\n]*)(,|\r?\n|$)', 'tokens');
rows = {{}};
for k = 1:numel(fields)
  field = fields{k}{1};
  if numel(field) > 1 && field(1) == '"', field = strrep(field(2:numel(field) - 1), '""', '"'); end
  rows{numel(rows)}{1, numel(rows{numel(rows)}) + 1} = field;
  if ~strcmp(fields{k}{2}, ','), rows{numel(rows) + 1} = {}; end %#ok<AGROW>
end
names = rows{1};
rows = rows(cellfun(@numel, rows) == numel(names));
table = vertcat(rows{:});
table = table(2:size(table, 1), :);
for k = find(ismember(names, {'t_s', 'until_s', 'count', 'agent'}))
  table(:, k) = num2cell(str2double(table(:, k)));  % an empty field is NaN
end
events = reshape(cell2struct(table, names, 2), [], 1);
end

function [names, values] = numbers_of(value, name)
names = {};
values = {};
if isstruct(value) && isscalar(value)
  for field = fieldnames(value).'
    inner = [name '.' field{1}];
    if isempty(name), inner = field{1}; end
    [more_names, more_values] = numbers_of(value.(field{1}), inner);
    names = [names, more_names]; %#ok<AGROW>
    values = [values, more_values]; %#ok<AGROW>
  end
elseif isnumeric(value) && isscalar(value) && ~isnan(value)
  names = {name};
  values = {value};
end
end
