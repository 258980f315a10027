function address = start_server(config, options)
% start_server(CONFIG, OPTIONS) starts `orchestrator serve` for one client, and returns its address once it listens.
% mascot.Team calls it, with its options. Error mascot:start: why there is no server, in its own words.
if ispc
  error('mascot:start', 'on Windows, start the server elsewhere, and give its address: mascot.Team(''host:8770'')');
end
words = [{program_of(options), 'serve', config, '--once', '--json', '--at', '127.0.0.1:0'}, words_of(options)];
command = strjoin(cellfun(@quoted, words, 'UniformOutput', false), ' ');
if ~exist('OCTAVE_VERSION', 'builtin'), command = ['env -u LD_LIBRARY_PATH ' command]; end  % MATLAB's own libraries

folder = tempname();
mkdir(folder);
files = struct('out', '', 'err', '', 'pid', '', 'code', '');
for name = fieldnames(files).'
  files.(name{1}) = fullfile(folder, name{1});
end
cleanup = onCleanup(@() remove(folder, files));
% A shell waits for the server, to note how it ended.
script = sprintf('{ %s > %s 2> %s < /dev/null & echo $! > %s; wait $!; echo $? > %s; } > /dev/null 2>&1 &', command, ...
                 quoted(files.out), quoted(files.err), quoted(files.pid), quoted(files.code));
if system(['/bin/sh -c ' quoted(script)]) ~= 0, error('mascot:start', 'cannot start %s', words{1}); end

started = tic();
found = [];
while isempty(found)
  ended = isfile(files.code);  % asked before its last words are read
  late = toc(started) > options.timeout_s;
  found = regexp(text_of(files.out), '^\{"address": *"([^"]*)"\}\n', 'tokens', 'once');
  if isempty(found) && ended
    error('mascot:start', '%s ended: %s', words{1}, strtrim(text_of(files.err)));
  elseif isempty(found) && late
    system(['kill ' strtrim(text_of(files.pid))]);
    error('mascot:start', '%s says no address within %g s: %s', words{1}, options.timeout_s, ...
          strtrim(text_of(files.err)));
  elseif isempty(found)
    pause(0.01);
  end
end
address = found{1};
end

function program = program_of(options)
program = options.orchestrator;
if ~isempty(program), return, end
here = fileparts(mfilename('fullpath'));  % share/mascot/matlab/+mascot
program = fullfile(here, '..', '..', '..', '..', 'bin', 'orchestrator');
if ~isfile(program), program = 'orchestrator'; end
end

function words = words_of(options)
% The options of mascot.Team as those of `orchestrator serve`.
words = {};
if ~isempty(options.ports), words = [words, {'--ports', regexprep(num2str(options.ports(:).'), '\s+', ',')}]; end
if ~isempty(options.seed), words = [words, {'--seed', sprintf('%.17g', options.seed)}]; end
if ~isempty(options.out), words = [words, {'--out', options.out}]; end
if ~isempty(options.engine), words = [words, {'--engine', options.engine}]; end
for k = 1:2:numel(options.set)
  value = options.set{k + 1};
  if ~ischar(value), value = mascot.json_text(value); end  % numbers and lists of TOML are those of JSON
  words = [words, {'--set', [options.set{k} '=' value]}]; %#ok<AGROW>
end
end

function word = quoted(word)
word = ['''' strrep(char(word), '''', '''\''''') ''''];
end

function text = text_of(path)
text = '';
if isfile(path), text = fileread(path); end
end

function remove(folder, files)
for path = struct2cell(files).'
  if isfile(path{1}), delete(path{1}); end
end
rmdir(folder);
end
