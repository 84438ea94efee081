"""What ``--help`` says: plain text, written for a person; the keys are made from their declarations."""

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
Reads and checks the records, estimates the parameters, scores the model in free run, over horizons
and under its controller, and draws the figures. Stages whose inputs and settings have not changed are reused;
each one says so.

  hybridid run case=emps
  hybridid run case=emps estimator.horizon=1000 effects=[viscous,coulomb,offset,asymmetric_viscous]
  hybridid run -m case=emps launcher=joblib estimator.horizon=250,1000,null
"""

PREPROCESS = """\
Maps the columns of each file to signals with units, checks them, applies preprocess.steps in order and writes
preprocess/. With no measured record at hand the case's virtual rig stands in, and all that follows says so.

  hybridid preprocess case=emps paths.data=/data/recordings
  hybridid preprocess case=emps 'preprocess.steps=[{step: decimate, factor: 10}]'
"""

FIT = """\
Estimates the parameters of plant and effects on the records of fit.records and writes fit/estimate.json. Says
first what the model leaves, beside the sensor's noise and beside doing nothing, and whether the model is
wrong: no better than doing nothing, or with a sign, a unit or a column changed. No standard error is stated
then. Lines of advice follow: which of two parameters to fix, which horizon to take, which record to add. Exit
code: 3 if the fit has not converged, 4 if the model is wrong; the results are written all the same, and run,
residual, validate and plot end like that after all their stages. A sweep and a trace go on.

  hybridid fit case=emps                            over the whole record, free running
  hybridid fit case=emps estimator.horizon=1000     over horizons of 1000 samples
  hybridid fit case=emps estimator=multiple_shooting parameters.M.fixed=95.1
"""

RESIDUAL = """\
Fits a network to what the gray box leaves of the records of fit.records and writes residual/: the hybrid, how
it came about, and how much of the network the model's own parameters could have explained. Held-out blocks of
those records decide its size, or when its training stops. With a network chosen, run, validate and plot take
up the hybrid beside the gray box.

  hybridid residual case=emps residual=rbf residual.nodes=[4,8,16,32]   inside the equations, at a port
  hybridid residual case=emps residual=narx                             after the output
  hybridid run case=emps residual=rbf                                   gray box and hybrid, with figures
  hybridid run experiment=vehicle_narx                                  the grid of Tables 4.4 and 4.5
"""

SWEEP = """\
Runs every point of a grid and puts the held-out errors of all in one table and a heat map, with the network
to keep of each output. Any key takes several values: key=a,b,c, key=range(1,10) or key=choice(a,b); lists of
residual.depth, width, seeds, nodes and horizons are a grid by themselves. Small networks train together in
stacks, large ones in workers of one thread; the plan is said first. A point that fails or is killed is named
and leaves the others; the same command again does what is missing, and so does a larger grid.

  hybridid sweep experiment=vehicle_narx                         the grid of Tables 4.4 and 4.5
  hybridid sweep experiment=vehicle_narx residual.depth=2,4,6 residual.width=8,1024 residual.orders.error=1,7
  hybridid sweep case=esea friction=linear,dahl residual=narx_esea
  hybridid sweep experiment=emps_rbf launcher=joblib             other processes; launcher=slurm: a cluster
"""

VALIDATE = """\
Runs the fitted model against every record and writes validate/metrics.json: MSE, RMSE, MAE, R2 and fit
percentage by record, output and view, and tests of the residual. A case with a controller is also run in the
loop: from its reference, the law closed over the simulated outputs; its control effort is scored too.

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
Adds every effect of the library at every port of its kind, refits all parameters together, and judges on
horizons that no fit has seen what the model lacks. Accepts an effect if its gain is significant, worth
having, determined by the records, and survives other ways to solve the equations; names together what the
records cannot tell apart; goes on until nothing passes. Writes trace/report.html, trace/trace.json and the
augmented model. Traces with other options stay beside it, in traces.

  hybridid trace case=emps
  hybridid trace case=emps effects=[viscous]                       with physics left out
  hybridid trace case=emps fit.records=[validation]                from one record alone
  hybridid trace case=emps trace.effects=[stribeck,dahl,lugre]     try only these
  hybridid trace --config-dir mylab case=mine trace.extra_effects=[mymodule:MY_EFFECT]
  hybridid run case=emps model=TREE/trace/model.json               go on with the augmented model
  hybridid trace -m --config-dir lab case=lab 'records.fitted.files=glob(../runs/*.csv)'
                                                                   many machines, one table (docs/fleet.md)
"""

CASES = """\
Lists each case: what it is, its plant, inputs, outputs, effects, and which records are at hand here.

  hybridid cases
  hybridid cases emps
  hybridid cases --config-dir mylab

  --config-dir DIR         cases of your own too
  paths.data=DIR           where measured records lie; default: $HYBRIDID_DATA, else data/raw
"""

EFFECTS = """\
Lists each effect: its name, where it acts, its equation, parameters with units, and source. With a name, also
what tells it from its look-alikes.

  hybridid effects
  hybridid effects viscous
  hybridid effects mymodule:MY_EFFECT --config-dir mylab
"""

REPRODUCE = """\
Runs the thesis' experiments side by side and writes its tables and figures beside ours, each with "measured"
or "simulated": outputs/thesis/index.html and index.md. What is fresh is reused, so an interrupted run goes on
where it stopped. An experiment that fails is named, on the page too, and does not touch the others.

  hybridid reproduce
  hybridid reproduce experiments=[emps_free_run] paths.outputs=/data/outputs
"""

FETCH = """\
Downloads the public records of a case to paths.data, checks their SHA-256 and resumes what was cut off.

  hybridid fetch emps
  hybridid fetch emps paths.data=/data/recordings
"""

TUNE = """\
Searches for the NARX network that leaves the least on the held-out blocks: Optuna proposes size, orders and
training from what earlier trials found, and ends early the trials that fall behind. The search lives in one
journal file: processes and nodes that start the same command take part in it, and a command that was stopped
or killed goes on where it was. Writes index.html, tune.json and the chosen config.

  hybridid tune experiment=vehicle_narx
  hybridid tune experiment=vehicle_narx tune.trials=200 tune.seconds=3600
  hybridid tune case=esea friction=linear residual=narx_esea tune.space.residual.width.high=32
  hybridid run --config-dir FOLDER experiment=tuned             take up what was chosen
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
signal, and a README. It finds out what the files tell: the time axis, units in the header, signals by their
names, typical magnitudes. What it cannot find out it asks; without a terminal it says what to give.

  hybridid new                                    list the templates
  hybridid new my_rig --from swing.csv --template rotary
  hybridid new my_rig --from a.csv b.csv --template carriage --signal force=cur --scale force=2.1

--signal SIGNAL=COLUMN   which column a signal is
--scale SIGNAL=NUMBER    the signal's unit over the column's, as N·m per A
--hold INPUT=HOLD        how an input runs between two samples: zoh (held), foh (linear) or bandlimited
--constant PARAMETER=COLUMN   a column with one number in each recording, as a gain: a parameter of the plant
--time COLUMN            the column of time stamps; or --rate HZ where there is none

Of several recordings the last one judges, and the others are fitted. Of a single one, the first 70 % are
fitted. The recordings stay where they are. Nothing is overwritten.
"""

LOG = """\
A run whose tracking server is down, slow or dies is complete, and kept in outputs/mlflow-waiting. This sends
every run that waits there to where it was to go, and says what it sent; whatever cuts it off, nothing is lost
or doubled. While something still waits, the exit code is 1.

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
