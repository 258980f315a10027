classdef Team < handle
% mascot.Team is a team of agents that waits to be stepped: the protocol of `orchestrator serve`, over TCP.
%
%   team = mascot.Team('configs/leaderless.toml', 'ports', [1 2]);   % starts a server (not on Windows)
%   team = mascot.Team('192.168.1.4:8770');                          % joins a server
%
%   team.reset(3, {'law.p_gain', 0.1});      % seed, keys and values
%   while ~team.over
%     team.step(-0.1 * team.p(1:2, :));      % one action for each port: a row each
%   end
%   team.close();
%
% Options, as names and values:
%   ports         agents that take actions in the place of their laws
%   seed          run.seed
%   set           keys and values: {'run.duration_s', 5, 'law.p_gain', 0.1}
%   timeout_s     how long an answer may take (s); default: 60
% and for a server that is started:
%   out           folder: each episode is recorded there, as 1, 2, ...
%   engine        'inprocess' or 'dds'
%   orchestrator  the program; default: the one that is installed with this file, or else the one on the path
%
% Positions are in W (m), x east, y north, z up; angular velocities in B (rad/s), x forward, y left, z up.
% Errors: mascot:server (in the words of the server), mascot:start, mascot:connection, mascot:option, mascot:actions.
% In Octave, the package instrument-control is needed.

  properties (SetAccess = private)
    about      % what the server says of the team: name, agents, rate_hz, ticks, ports, figures, keys (docs/serve.md)
    tick       % the tick of the state below
    t          % its simulated time (s)
    over       % whether the episode is over: no step is possible until reset()
    failed     % whether the episode ended before its time; look() reads why
    p          % (agents x 3) positions in W (m)
    v          % (agents x 3) velocities in W (m/s)
    attitude   % (agents x 4) unit quaternions x, y, z, w, w >= 0, from B to W
    w          % (agents x 3) angular velocities in B (rad/s)
    lost       % agents that are lost, a row
    heard      % (agents x 1 cell) from which agents each has heard so far, a row each
    figures    % struct: figures of this tick by name, NaN where there is none
    failure    % why the episode ended before its time, as look() has read it
    recording  % folder of the newest recorded episode, as look() has read it
  end

  properties (Access = private)
    socket = [];
    timeout_s = 60;
  end

  methods
    function team = Team(where, varargin)
      where = char(where);
      options = mascot.Team.options_of(varargin);
      team.timeout_s = options.timeout_s;
      joins = ~isempty(regexp(where, '^[^/\\]*:\d+$', 'once'));
      if joins
        if ~isempty([options.out options.engine options.orchestrator])
          error('mascot:option', ...
                'out, engine and orchestrator are for a server that is started, and %s is one that runs', where);
        end
        address = where;
      else
        address = mascot.start_server(where, options);
      end
      team.connect(address);
      if joins && ~(isempty(options.seed) && isempty(options.set) && isempty(options.ports))
        team.reset(options.seed, options.set, options.ports);
      else
        team.look();
      end
    end

    function delete(team)
      team.close();
    end

    function close(team)
      % Ends the connection, and with it a server that was started for this team.
      if isempty(team.socket), return, end
      try
        team.ask('close');
      catch  % the server is gone already
      end
      team.socket = [];
    end

    function reset(team, seed, sets, ports)
      % reset(SEED, SETS, PORTS) begins an episode. What is left out, or [], is as before, and the seed as the server
      % was started with. SETS: {'law.p_gain', 0.1, ...}; {}: none.
      fields = struct();
      if nargin > 1 && ~isempty(seed), fields.seed = seed; end
      if nargin > 2 && iscell(sets), fields.set = mascot.Team.keys_of(sets); end
      new_ports = nargin > 3 && ~isempty(ports);
      if new_ports, fields.ports = num2cell(ports(:).'); end
      team.ask('reset', fields);
      if new_ports, team.read_about(team.ask('hello', struct('protocol', 1, 'form', 'binary'))); end
      team.look();
    end

    function step(team, actions, ticks)
      % step(ACTIONS, TICKS) flies on, by default one tick. ACTIONS: a row for each port, as about.ports has them:
      % what the agent wants in W along x, y and z, and then the numbers of its message. []: those before hold; the
      % first are 0.
      if nargin < 2, actions = []; end
      if nargin < 3, ticks = 1; end
      numbers = sum([team.about.ports.numbers]);
      if ~isempty(actions) && numel(actions) ~= numbers
        error('mascot:actions', 'expected %d numbers for %d ports, got %d', numbers, numel(team.about.ports), ...
              numel(actions));
      end
      if ~(isscalar(ticks) && ticks >= 0 && ticks == fix(ticks) && ticks <= 1000000)
        error('mascot:actions', 'expected an integer from 0 to 1000000 as ticks');
      end
      team.send('S', [typecast(uint32(ticks), 'uint8'), typecast(reshape(double(actions).', 1, []), 'uint8')]);
      [kind, content] = team.receive();
      if kind ~= 'S'
        problem = jsondecode(native2unicode(content, 'UTF-8'));
        team.look();  % a law that fails ends the episode
        error('mascot:server', '%s', problem.error);
      end
      team.read_state(content);
    end

    function tick = set(team, sets, agents)
      % set(SETS, AGENTS) changes live keys from the next tick on, which it returns. SETS: {'law.p_gain', 0.5, ...};
      % AGENTS: for which; default: all.
      fields = struct('set', mascot.Team.keys_of(sets));
      if nargin > 2, fields.agents = num2cell(agents(:).'); end
      answer = team.ask('set', fields);
      tick = answer.tick;
    end

    function tick = goto(team, agent, position)
      % goto(AGENT, POSITION) sends an agent to a place in W (m), from the next tick on, which it returns.
      answer = team.ask('goto', struct('agent', agent, 'position_m', position(:).'));
      tick = answer.tick;
    end

    function tick = event(team, happening)
      % event(HAPPENING) is any event, as a struct with the keys of [[events]] but at_s, from the next tick on, which
      % it returns: team.event(struct('fault', struct('agent', 2, 'kind', 'kill'))). A list of one number is a cell:
      % {3}.
      answer = team.ask('event', struct('event', happening));
      tick = answer.tick;
    end

    function kept = snapshot(team, form)
      % snapshot() keeps the episode so far, and returns its number; snapshot('text') returns it as text.
      if nargin < 2, form = 'number'; end
      answer = team.ask('snapshot', struct('form', form));
      if isfield(answer, 'text'), kept = answer.text; else, kept = answer.snapshot; end
    end

    function restore(team, kept)
      % restore(KEPT) goes back to a snapshot, a number or a text.
      if ischar(kept), name = 'text'; else, name = 'snapshot'; end
      team.ask('restore', struct(name, kept));
      team.read_about(team.ask('hello', struct('protocol', 1, 'form', 'binary')));  % it may have other ports
      team.look();
    end

    function forget(team, kept)
      % forget(KEPT) drops a snapshot by its number.
      team.ask('forget', struct('snapshot', kept));
    end

    function look(team)
      % Reads the state again, with `failure` and `recording`.
      team.step([], 0);
      answer = team.ask('look');
      team.failure = answer.failure;
      team.recording = '';
      if isfield(answer, 'recording'), team.recording = answer.recording; end
    end
  end

  methods (Access = private)
    function connect(team, address)
      if exist('OCTAVE_VERSION', 'builtin'), pkg('load', 'instrument-control'); end
      colon = find(address == ':', 1, 'last');
      host = address(1:colon - 1);
      if isempty(host), host = '127.0.0.1'; end
      try
        team.socket = tcpclient(host, str2double(address(colon + 1:end)), 'Timeout', team.timeout_s);
      catch problem
        error('mascot:connection', 'cannot connect to %s: %s', address, problem.message);
      end
      team.put(uint8(sprintf('{"request":"hello","protocol":1,"form":"binary"}\n')));
      line = zeros(1, 0, 'uint8');
      while isempty(line) || line(numel(line)) ~= 10  % after the answer, the server says nothing unasked
        line = [line, team.take(max(1, double(team.socket.NumBytesAvailable)))]; %#ok<AGROW>
      end
      team.read_about(mascot.Team.checked(mascot.decode_json(native2unicode(line, 'UTF-8'))));
    end

    function answer = ask(team, request, fields)
      if nargin < 3, fields = struct(); end
      fields.request = request;
      team.send('J', unicode2native(mascot.json_text(fields), 'UTF-8'));
      [~, content] = team.receive();
      text = native2unicode(content, 'UTF-8');
      if strcmp(request, 'hello'), answer = mascot.decode_json(text); else, answer = jsondecode(text); end
      mascot.Team.checked(answer);
    end

    function send(team, kind, content)
      if isempty(team.socket), error('mascot:connection', 'this team is closed'); end
      team.put([typecast(uint32(1 + numel(content)), 'uint8'), uint8(kind), reshape(content, 1, [])]);
    end

    function put(team, bytes)
      try
        write(team.socket, bytes, 'uint8');
      catch problem  % not in Octave, which tells of a lost connection when it reads
        team.leave(problem.message);
      end
    end

    function [kind, content] = receive(team)
      head = team.take(5);
      kind = char(head(5));
      content = team.take(double(typecast(head(1:4), 'uint32')) - 1);
    end

    function bytes = take(team, count)
      bytes = zeros(1, 0, 'uint8');
      if count == 0, return, end
      reason = sprintf('it said nothing for %g s', team.timeout_s);
      try
        bytes = reshape(uint8(read(team.socket, count, 'uint8')), 1, []);
      catch problem
        reason = problem.message;
      end
      if numel(bytes) ~= count  % what comes later would be taken for another answer
        team.leave(reason);
      end
    end

    function leave(team, reason)
      team.socket = [];
      error('mascot:connection', 'no answer of the server: %s', reason);
    end

    function read_about(team, answer)
      if isempty(answer.ports), answer.ports = struct('agent', {}, 'numbers', {}, 'wants', {}, 'unit', {}); end
      team.about = answer;
    end

    function read_state(team, content)
      counts = double(typecast(content(9:20), 'uint32'));  % flags, agents, figures
      agents = counts(2);
      team.tick = double(typecast(content(1:8), 'int64'));
      team.t = team.tick / team.about.rate_hz;
      team.over = bitand(counts(1), 1) ~= 0;
      team.failed = bitand(counts(1), 2) ~= 0;
      at = 20 + 8 * counts(3);
      values = typecast(content(21:at), 'double');
      for k = 1:counts(3)
        team.figures.(team.about.figures(k).name) = values(k);
      end
      numbers = zeros(agents, 13);
      heard = cell(agents, 1);
      is_lost = false(1, agents);
      for k = 1:agents
        numbers(k, :) = typecast(content(at + 1:at + 104), 'double');
        words = double(typecast(content(at + 105:at + 112), 'uint32'));  % lost, and from how many it has heard
        is_lost(k) = words(1) ~= 0;
        heard{k} = double(typecast(content(at + 113:at + 112 + 4 * words(2)), 'uint32'));
        at = at + 112 + 4 * words(2);
      end
      team.p = numbers(:, 1:3);
      team.v = numbers(:, 4:6);
      team.attitude = numbers(:, 7:10);
      team.w = numbers(:, 11:13);
      team.heard = heard;
      team.lost = find(is_lost);
    end
  end

  methods (Static, Access = private)
    function answer = checked(answer)
      if isfield(answer, 'error'), error('mascot:server', '%s', answer.error); end
    end

    function map = keys_of(sets)
      % {'law.p_gain', 0.1} as an object of JSON: keys with dots are no names of fields.
      if mod(numel(sets), 2) ~= 0 || ~all(cellfun(@ischar, sets(1:2:end)))
        error('mascot:option', 'expected keys and values, such as {''law.p_gain'', 0.1}');
      end
      map = containers.Map('KeyType', 'char', 'ValueType', 'any');
      for k = 1:2:numel(sets)
        map(sets{k}) = sets{k + 1};
      end
    end

    function options = options_of(pairs)
      options = struct('ports', [], 'seed', [], 'set', {{}}, 'out', '', 'engine', '', 'orchestrator', '', ...
                       'timeout_s', 60);
      for k = 1:2:numel(pairs)
        name = char(pairs{k});
        if ~isfield(options, name) || k == numel(pairs)
          error('mascot:option', 'expected one of %s, with a value, got %s', ...
                strjoin(fieldnames(options).', ', '), name);
        end
        options.(name) = pairs{k + 1};
      end
    end
  end
end
