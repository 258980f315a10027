function msfun_team(block)
% msfun_team is a Level-2 MATLAB S-function: a team of agents that Simulink steps, by mascot.Team.
%
% In a block "Level-2 MATLAB S-Function", name msfun_team, and give as parameters:
%   1  the experiment file, or the address of a server ('192.168.1.4:8770', which must run without --once)
%   2  agents that take actions, for example [1 2]; []: none
%   3  run.seed; []: as the file has it
%   4  options of mascot.Team, for example {'set', {'law.p_gain', 0.1}, 'out', 'runs/simulink'}; {}: none
%
% Input, if there are agents that take actions: a row for each of them, what it wants in W along x, y and z, and then
% the numbers of its message, one row after the other in a vector. Outputs:
%   1  positions in W (m), agents x 3            4  angular velocities in B (rad/s), agents x 3
%   2  velocities in W (m/s), agents x 3         5  1: the episode is over, and the other outputs stay as they are
%   3  unit quaternions x, y, z, w, agents x 4
%
% The block is discrete, with the rate of the team (control.rate_hz). Its outputs at tick k do not depend on its input
% at tick k, which acts from k to k + 1. A step cannot be taken back: no stepping back, and no saved operating point.
block.NumDialogPrms = 4;
team = open_team(block, false);  % Simulink asks for sizes and the sample time when the model does not run, too
agents = team.about.agents;
numbers = sum([team.about.ports.numbers]);
rate_hz = team.about.rate_hz;
team.close();

widths = [3 3 4 3];
block.NumInputPorts = double(numbers > 0);
block.NumOutputPorts = numel(widths) + 1;
block.SetPreCompInpPortInfoToDynamic;
block.SetPreCompOutPortInfoToDynamic;
if numbers > 0
  block.InputPort(1).Dimensions = numbers;
  block.InputPort(1).DatatypeID = 0;  % double
  block.InputPort(1).Complexity = 'Real';
  block.InputPort(1).DirectFeedthrough = false;
end
for k = 1:numel(widths)
  block.OutputPort(k).Dimensions = [agents widths(k)];
end
block.OutputPort(numel(widths) + 1).Dimensions = 1;
for k = 1:numel(widths) + 1
  block.OutputPort(k).DatatypeID = 0;
  block.OutputPort(k).Complexity = 'Real';
  block.OutputPort(k).SamplingMode = 'Sample';
end
block.SampleTimes = [1 / rate_hz 0];
block.SimStateCompliance = 'DisallowSimState';
block.RegBlockMethod('SetInputPortSamplingMode', @set_sampling_mode);
block.RegBlockMethod('Start', @start);
block.RegBlockMethod('InitializeConditions', @initialize);
block.RegBlockMethod('Outputs', @outputs);
block.RegBlockMethod('Update', @update);
block.RegBlockMethod('Terminate', @terminate);
end

function set_sampling_mode(block, port, mode)
block.InputPort(port).SamplingMode = mode;
end

function start(block)
teams(block.BlockHandle, open_team(block, true));
end

function initialize(block)
team = teams(block.BlockHandle);
if team.tick > 0, team.reset(); end
end

function outputs(block)
team = teams(block.BlockHandle);
values = {team.p, team.v, team.attitude, team.w, double(team.over)};
for k = 1:numel(values)
  block.OutputPort(k).Data = values{k};
end
end

function update(block)
team = teams(block.BlockHandle);
if team.over, return, end
actions = [];
if block.NumInputPorts > 0, actions = block.InputPort(1).Data; end
team.step(reshape(actions, 1, []));
end

function terminate(block)
team = teams(block.BlockHandle);
if ~isempty(team), team.close(); end
teams(block.BlockHandle, []);
end

function team = open_team(block, records)
options = block.DialogPrm(4).Data;
if ~records  % there will be no episode
  out = 2 * find(strcmp(options(1:2:end), 'out')) - 1;
  options([out, out + 1]) = [];
end
team = mascot.Team(block.DialogPrm(1).Data, 'ports', block.DialogPrm(2).Data, 'seed', block.DialogPrm(3).Data, ...
                   options{:});
end

function team = teams(handle, team)
% The team of a block while the model runs; a Dwork vector of Simulink holds numbers alone.
persistent open
if isempty(open), open = containers.Map('KeyType', 'char', 'ValueType', 'any'); end
key = sprintf('%.17g', handle);
if nargin > 1, open(key) = team; end
if nargin > 1 && isempty(team), remove(open, key); end
team = [];
if isKey(open, key), team = open(key); end
end
