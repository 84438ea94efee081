"""The texts of ``--help``. The list of config keys is made from their declarations."""

from __future__ import annotations

from collections.abc import Sequence

_OVERVIEW = """\
hybridid: from a measured record and the physics you believe in, to a model that is accurate and still physics

  hybridid <command> [case=NAME] [key=value ...] [flags]

{commands}

A first look
  hybridid run case=emps                         record, fit, validation and plots of one machine
  hybridid run case=emps estimator.horizon=1000  fitted over horizons of 1000 samples instead
  hybridid effects                               the physics that can be composed onto a machine

hybridid <command> --help tells more of a command. eval "$(hybridid completion bash)" completes names.
"""

_SHARED = """\
Keys that every stage knows (hybridid {name} --cfg job prints them all)
  case=NAME                the machine and its records (hybridid cases); default: emps
  effects=[a,b@port,...]   the physics at its ports (hybridid effects)
  model=FILE               model.json of fit or trace, in place of plant, effects and parameters
  parameters.NAME.KEY=X    guess, lower, upper or fixed of one parameter, as in parameters.M.lower=30;
                           by=record estimates one value for each record
  data=measured|simulated  insist on measured records, or on the case's virtual rig; default: auto
  paths.data=DIR           where measured records lie; default: $HYBRIDID_DATA, else data/raw
  out=DIR                  {out}
  mlflow.enabled=false     do not log the run; mlflow.tracking_uri=http://HOST:PORT logs it to a server

Flags
  -m                       sweep: estimator.horizon=250,1000 runs both; launcher=joblib side by side,
                           launcher=slurm on a cluster
  --cfg job                print the config that would be used, and stop
  --config-dir DIR         cases, plants and effects of your own: DIR/case/mine.yaml and Python files in DIR
  --debug                  show where in the code an error arose
"""

_OUT = {
    "sweep": """\
the report and every point's run tree; default: outputs/sweeps/<name>-<digest>,
                           and each point where hybridid run would put it""",
    "tune": "all that the search writes; default: outputs/<case>/tune-<digest>",
}
_TREE = "put the whole run tree there; default: outputs/<case>/<hash of the config>"

RUN = """\
Reads and checks the records, estimates the parameters, scores the model in free run, over horizons and under
its controller, and draws the figures. A stage runs only if its inputs or settings have changed. Otherwise its
results are reused, and the command says so.

  hybridid run case=emps
  hybridid run case=emps estimator.horizon=1000 effects=[viscous,coulomb,offset,asymmetric_viscous]
  hybridid run -m case=emps launcher=joblib estimator.horizon=250,1000,null
"""

PREPROCESS = """\
Maps the columns of each file to signals with units, checks them, applies preprocess.steps in order and writes
preprocess/. If there is no measured record, the case's virtual rig simulates the records. Every result then
says "simulated".

  hybridid preprocess case=emps paths.data=/data/recordings
  hybridid preprocess case=emps 'preprocess.steps=[{step: decimate, factor: 10}]'
"""

FIT = """\
Estimates the parameters of plant and effects on the records of fit.records and writes fit/estimate.json.
First it prints the remaining error beside the sensor's noise, and beside the error of a model that does
nothing. It also says whether the model is wrong: no better than doing nothing, or with a wrong sign, unit or
column. For a wrong model it states no standard errors. Then it gives advice: which of two parameters to fix,
which horizon to use, which record to add. The exit code is 3 if the fit has not converged,
and 4 if the model is wrong. The results are written in both cases. The commands run, residual, validate and
plot carry out all their stages first, and then end with the same code. The commands sweep and trace continue.

  hybridid fit case=emps                            over the whole record, free running
  hybridid fit case=emps estimator.horizon=1000     over horizons of 1000 samples
  hybridid fit case=emps estimator=multiple_shooting parameters.M.fixed=95.1
"""

RESIDUAL = """\
Fits a network to the error of the gray box on the records of fit.records. Writes residual/: the hybrid model,
the report of its training, and the share of the network's output that the model's own parameters could have
explained. Held-out blocks of those records decide the size of the network, or when its training stops. If a
network is configured, run, validate and plot show the hybrid beside the gray box.

  hybridid residual case=emps residual=rbf residual.nodes=[4,8,16,32]   inside the equations, at a port
  hybridid residual case=emps residual=narx                             after the output
  hybridid run case=emps residual=rbf                                   gray box and hybrid, with figures
  hybridid run experiment=vehicle_narx                                  the grid of Tables 4.4 and 4.5
"""

SWEEP = """\
Runs every point of a grid. Puts the held-out errors of all points in one table and a heat map, and chooses
one network for each output. Any key takes several values: key=a,b,c, key=range(1,10) or key=choice(a,b).
Lists of residual.depth, width, seeds, nodes and horizons are a grid by themselves. Small networks train
together in stacks, large ones in processes of one thread. The plan is printed first. If a point fails or is
killed, its name is printed and the other points continue. The same command again, or one with a larger grid,
runs only the points without results.

  hybridid sweep experiment=vehicle_narx                         the grid of Tables 4.4 and 4.5
  hybridid sweep experiment=vehicle_narx residual.depth=2,4,6 residual.width=8,1024 residual.orders.error=1,7
  hybridid sweep case=esea friction=linear,dahl residual=narx_esea
  hybridid sweep experiment=emps_rbf launcher=joblib             other processes; launcher=slurm: a cluster
"""

VALIDATE = """\
Runs the fitted model against every record and writes validate/metrics.json: MSE, RMSE, MAE, R2 and fit
percentage by record, output and view, and tests of the residual. If the case has a controller, the model is
also simulated in closed loop from the reference, and the control effort is scored too.

  hybridid validate case=emps validate.horizon=0.5
  hybridid validate case=emps controller.parameters.kp=150     another gain; controller=null: no loop
"""

PLOT = """\
Draws record, model against data, error, friction over velocity, spectrum, residual correlation and the
spread of errors, as files for a paper. Of more than four records, it draws the one with the largest error,
the median and the one with the smallest.

  hybridid plot case=emps
  hybridid plot case=emps plot.formats=[svg,pdf,png]    files for a paper and for slides, too
  hybridid plot case=servo plot.records=all             the figures of every record
  hybridid plot case=servo plot.records=[sin_sin*]      of these
"""

TRACE = """\
Finds the effects that the model lacks. Adds each effect of the library at each port of its kind and refits
all parameters. Judges each refit on horizons that were not fitted. Accepts an effect if its gain is
significant and large enough, if the records determine its parameters, and if other solvers give the same
answer. Reports effects that the records cannot distinguish as one class. Repeats this until no effect is
accepted. Writes trace/report.html, trace/trace.json and the augmented model. Traces with other options stay
in the folder traces.

  hybridid trace case=emps
  hybridid trace case=emps effects=[viscous]                       with physics left out
  hybridid trace case=emps fit.records=[validation]                from one record alone
  hybridid trace case=emps trace.effects=[stribeck,dahl,lugre]     try only these
  hybridid trace --config-dir mylab case=mine trace.extra_effects=[mymodule:MY_EFFECT]
  hybridid run case=emps model=TREE/trace/model.json               use the augmented model
  hybridid trace -m --config-dir lab case=lab 'records.fitted.files=glob(../runs/*.csv)'
                                                                   many machines, one table (docs/fleet.md)
"""

CASES = """\
Lists each case: what it is, its plant, inputs, outputs, effects, and which of its records are found here.

  hybridid cases
  hybridid cases emps
  hybridid cases --config-dir mylab

  --config-dir DIR         cases of your own too
  paths.data=DIR           where measured records lie; default: $HYBRIDID_DATA, else data/raw
"""

EFFECTS = """\
Lists each effect: its name, where it acts, its equation, parameters with units, and source. With a name, also
how it differs from similar effects.

  hybridid effects
  hybridid effects viscous
  hybridid effects mymodule:MY_EFFECT --config-dir mylab
"""

REPRODUCE = """\
Runs the thesis' experiments in parallel. Writes the thesis' tables and figures beside ours, each marked
"measured" or "simulated": outputs/thesis/index.html and index.md. Results that are up to date are reused, so
an interrupted run continues where it stopped. If an experiment fails, the page and the terminal name it, and
the other experiments continue.

  hybridid reproduce
  hybridid reproduce experiments=[emps_free_run] paths.outputs=/data/outputs
"""

FETCH = """\
Downloads the public records of a case to paths.data and checks their SHA-256. Continues an interrupted
download.

  hybridid fetch emps
  hybridid fetch emps paths.data=/data/recordings
"""

TUNE = """\
Searches for the NARX network with the smallest error on the held-out blocks. Optuna proposes the size, the
orders and the training settings from the results of earlier trials. It stops a trial early if its error is
large compared with that of other trials at the same share of their training. One journal file holds the
search. Every process or node that starts the same command takes part in it. If a command was stopped or
killed, the same command continues the search. Writes index.html, tune.json and the chosen config.

  hybridid tune experiment=vehicle_narx
  hybridid tune experiment=vehicle_narx tune.trials=200 tune.seconds=3600
  hybridid tune case=esea friction=linear residual=narx_esea tune.space.residual.width.high=32
  hybridid run --config-dir FOLDER experiment=tuned             use the chosen config
"""

TRUST = """\
A model.json from somebody else may name code of theirs, as a plant or an effect. It runs only if you trust
the folder where it lies. This trusts all code in a folder until a file of it changes. Read the code first:
when it runs, it can do whatever you can do. On a terminal, a command that needs such code asks. A folder that
you name by --config-dir needs no trust. SECURITY.md says more.

  hybridid trust ../their-models
  hybridid trust                          list what is trusted
"""

NEW = """\
Reads your recordings and writes a folder: a plant from a template, a case that says which column is which
signal, and a README. It reads from the files: the time axis, units in the header, signals by their names,
typical magnitudes. It asks for everything else. Without a terminal it names the options to give.

  hybridid new                                    list the templates
  hybridid new my_rig --from swing.csv --template rotary
  hybridid new my_rig --from a.csv b.csv --template carriage --signal force=cur --scale force=2.1
  hybridid new my_rig --from motor.mat+link.mat --template two_inertias   two files of one recording

--signal SIGNAL=COLUMN   which column a signal is, once for each; the unit in its header may be left out
--signal SIGNAL=none     the machine lacks it: nothing drives it, as in a coast-down, or it is not measured
--scale SIGNAL=NUMBER    the signal's unit over the column's, as N·m per A
--hold INPUT=HOLD        how an input runs between two samples: zoh (held), foh (linear) or bandlimited
--constant PARAMETER=COLUMN   a column with one number in each recording, as a gain: a parameter of the plant
--time COLUMN            the column of time stamps; or --rate HZ where there is none
--time-unit UNIT         the unit of the stamps, as ms, where their header names none
--simulated              the recordings are no measurements: every result says "simulated"

Of several recordings, the last one validates the model and the others are fitted. Of a single one, the first
70 % are fitted and the rest validates. The recordings stay where they are. Nothing is overwritten.
"""

LOG = """\
If the tracking server is down or slow, a command keeps its run in outputs/mlflow-waiting. The run is complete
there. This command sends every waiting run to its server, and lists what it sent. It may be interrupted at
any time: no run is lost, and none is stored twice. The exit code is 1 if a run still waits.

  hybridid log
  hybridid log paths.outputs=/data/outputs
  hybridid log mlflow.tracking_uri=http://server:5000   all of them to this server
"""

UI = """\
Opens MLflow's page on this machine alone (127.0.0.1): every run with its config, metrics, figures and files.

  hybridid ui
  hybridid ui port=8080 paths.outputs=/data/outputs
"""

COMPLETION = """\
Prints the script that teaches a shell to complete commands, cases, keys and effects.

  eval "$(hybridid completion bash)"             now
  echo 'eval "$(hybridid completion bash)"' >> ~/.bashrc
"""


def overview(commands: Sequence[tuple[str, str]]) -> str:
    """The text of ``hybridid --help``."""
    lines = ["Commands", *[f"  {name:<12} {summary}" for name, summary in commands]]
    return _OVERVIEW.format(commands="\n".join(lines))


def of_command(name: str, summary: str, details: str, stages: bool) -> str:
    """The text of ``hybridid <command> --help``."""
    parts = [f"hybridid {name}: {summary}\n\n{details}"]
    if stages:
        from hybridid_cli import keys  # the overview needs no keys

        parts.append(keys.of_command(name))
    if stages and name not in ("ui", "fetch", "log"):
        parts.append(_SHARED.format(name=name, out=_OUT.get(name, _TREE)))
    return "\n".join(part for part in parts if part)
