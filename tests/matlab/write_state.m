function write_state(file, team)
% Adds a line of JSON with the state of TEAM to FILE; NaN is null.
values = [team.p, team.v, team.attitude, team.w];
heard = cellfun(@(ids) num2cell(ids), team.heard, 'UniformOutput', false);
figures = struct2cell(team.figures);
texts = {'null'};
for k = 1:numel(figures)
  if isnan(figures{k}), texts{k} = 'null'; else, texts{k} = mascot.json_text(figures{k}); end
end
form = '{"tick":%d,"t":%.17g,"over":%d,"failed":%d,"numbers":%s,"heard":%s,"lost":%s,"figures":[%s]}\n';
fprintf(file, form, team.tick, team.t, team.over, team.failed, mascot.json_text(values), mascot.json_text(heard), ...
        mascot.json_text(num2cell(team.lost)), strjoin(texts, ','));
end
