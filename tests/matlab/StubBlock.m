classdef StubBlock < handle
% StubBlock plays the part of Simulink for a Level-2 MATLAB S-function: Simulink.MSFcnRunTimeBlock and the order in
% which Simulink calls the methods. Inputs are NaN but in the methods that may read them; an output must have its
% port's size.

  properties
    BlockHandle
    NumDialogPrms
    NumInputPorts
    NumOutputPorts
    DialogPrm
    InputPort
    OutputPort
    SampleTimes
    SimStateCompliance
    methods_ = struct();
    is_dynamic = [false false];
  end

  methods
    function block = StubBlock(handle, parameters)
      block.BlockHandle = handle;
      block.DialogPrm = struct('Data', parameters);
      block.InputPort = struct('Dimensions', {}, 'DatatypeID', {}, 'Complexity', {}, 'DirectFeedthrough', {}, ...
                               'SamplingMode', {}, 'Data', {});
      block.OutputPort = struct('Dimensions', {}, 'DatatypeID', {}, 'Complexity', {}, 'SamplingMode', {}, 'Data', {});
    end

    function SetPreCompInpPortInfoToDynamic(block)
      block.is_dynamic(1) = true;
    end

    function SetPreCompOutPortInfoToDynamic(block)
      block.is_dynamic(2) = true;
    end

    function RegBlockMethod(block, name, method)
      known = {'SetInputPortSamplingMode', 'Start', 'InitializeConditions', 'Outputs', 'Update', 'Terminate'};
      assert(ismember(name, known), name);
      block.methods_.(name) = method;
    end

    function begin(block)
      assert(block.NumDialogPrms == numel(block.DialogPrm) && all(block.is_dynamic));
      assert(numel(block.InputPort) == block.NumInputPorts && numel(block.OutputPort) == block.NumOutputPorts);
      for k = 1:block.NumInputPorts
        block.methods_.SetInputPortSamplingMode(block, k, 'Sample');
      end
      block.methods_.Start(block);
      block.methods_.InitializeConditions(block);
    end

    function values = outputs(block)
      % The outputs of this tick; a port whose input goes to no output at the same tick must not read it.
      for k = 1:block.NumInputPorts
        assert(~block.InputPort(k).DirectFeedthrough);
        block.InputPort(k).Data = NaN(block.InputPort(k).Dimensions, 1);
      end
      block.methods_.Outputs(block);
      values = cell(1, block.NumOutputPorts);
      for k = 1:block.NumOutputPorts
        values{k} = block.OutputPort(k).Data;
        expected = block.OutputPort(k).Dimensions;
        if isscalar(expected), expected = [expected 1]; end
        assert(isequal(size(values{k}), expected));
        assert(isa(values{k}, 'double') && block.OutputPort(k).DatatypeID == 0);
      end
    end

    function update(block, input)
      if block.NumInputPorts > 0
        assert(numel(input) == block.InputPort(1).Dimensions);
        block.InputPort(1).Data = input;
      end
      block.methods_.Update(block);
    end

    function terminate(block)
      block.methods_.Terminate(block);
    end
  end
end
