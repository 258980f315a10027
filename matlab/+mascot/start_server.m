function address = start_server(config, options)
% start_server(CONFIG, OPTIONS) starts `orchestrator serve` for one client, and returns its address once it listens. It is
% for mascot.Team, whose options it takes. Error mascot:start: why there is no server, in its own words.
if ispc
  error('mascot:start', 'on Windows, start the server elsewhere, and give its address: mascot.Team(''host:8770'')');
end
program = options.orchestrator;
if isempty(program)
  here = fileparts(mfilename('fullpath'));  % share/mascot/matlab/+mascot
  program = fullfile(here, '..', '..', '..', '..', 'bin', 'orchestrator');
  if ~exist(program, 'file'), program = 'orchestrator'; end
end
words = {program, 'serve', config, '--once', '--json', '--at', '127.0.0.1:0'};
if ~isempty(options.ports)
  words = [words, {'--ports', strjoin(arrayfun(@(id) sprintf('%d', id), options.ports(:).', 'UniformOutput', false), ',')}];
end
if ~isempty(options.seed), words = [words, {'--seed', sprintf('%.17g', options.seed)}]; end
if ~isempty(options.out), words = [words, {'--out', options.out}]; end
if ~isempty(options.engine), words = [words, {'--engine', options.engine}]; end
for k = 1:2:numel(options.set)
  value = options.set{k + 1};
  if ~ischar(value), value = mascot.json_text(value); end  % numbers and lists of TOML are those of JSON
  words = [words, {'--set', [options.set{k} '=' value]}]; %#ok<AGROW>
end

folder = tempname();
mkdir(folder);
cleanup = onCleanup(@() rmdir(folder, 's'));
file = @(name) fullfile(folder, name);
command = strjoin(cellfun(@quoted, words, 'UniformOutput', false), ' ');
if ~exist('OCTAVE_VERSION', 'builtin'), command = ['env -u LD_LIBRARY_PATH ' command]; end  % MATLAB's own libraries
status = system(sprintf('{ %s > %s 2> %s < /dev/null; echo $? > %s; } > /dev/null 2>&1 &', command, quoted(file('out')), ...
                        quoted(file('err')), quoted(file('code'))));
if status ~= 0, error('mascot:start', 'cannot start %s', program); end

waited = tic();
line = [];
while isempty(line)
  ended = exist(file('code'), 'file') ~= 0;  % asked before what it has written is read
  line = regexp(text_of(file('out')), '^\{"address": *"([^"]*)"\}\n', 'tokens', 'once');
  if isempty(line) && (ended || toc(waited) > options.timeout_s)
    error('mascot:start', '%s', strtrim(text_of(file('err'))));
  end
  if isempty(line), pause(0.01); end
end
address = line{1};
end

function word = quoted(word)
word = ['''' strrep(char(word), '''', '''\''''') ''''];
end

function text = text_of(path)
text = '';
if exist(path, 'file'), text = fileread(path); end
end
