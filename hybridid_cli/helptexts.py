"""What ``--help`` says: plain text, written for a person, ready without importing anything."""

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
  parameters.NAME.KEY=X    guess, lower, upper or fixed of one parameter, as in parameters.M.lower=30
  data=measured|simulated  insist on measured records, or on the case's virtual rig; default: auto
  paths.data=DIR           where measured records lie; default: $HYBRIDID_DATA, else data/raw
  out=DIR                  put the whole run tree there; default: outputs/<case>/<hash of the config>
  mlflow.enabled=false     do not log the run; mlflow.tracking_uri=http://HOST:PORT logs it to a server

Flags
  -m                       sweep: estimator.horizon=250,1000 runs both; launcher=joblib side by side
  --cfg job                print the config that would be used, and stop
  --config-dir DIR         cases, plants and effects of your own: DIR/case/mine.yaml and Python files in DIR
  --debug                  show where in the code an error arose
"""

RUN = """\
Reads and checks the records, estimates the parameters, scores the model in free run and over horizons, and
draws the figures. Stages whose inputs and settings have not changed are reused; each one says so.

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
Estimates the parameters of plant and effects on the records of fit.records and writes fit/estimate.json.

  hybridid fit case=emps                            over the whole record, free running
  hybridid fit case=emps estimator.horizon=1000     over horizons of 1000 samples
  hybridid fit case=emps estimator=multiple_shooting parameters.M.fixed=95.1

Its own keys
  fit.records=[...]        roles or names of the records to fit; default: [identification]
  estimator=NAME           gauss_newton | multiple_shooting
  estimator.horizon=N      samples over which the model runs free; null: the whole record
  estimator.interval=N     samples between shooting states
  estimator.starts=N       how many starts; the best is kept
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

Keys of residual=narx
  residual.orders.error=N  past errors that the network sees; orders.gray: of the gray box' output;
                           orders.inputs: of each input, or orders.inputs={torque: 6} by name
  residual.depth=N         hidden layers; residual.width=N neurons in each. Lists, such as depth=[3,4,5]
                           width=[8,16,32], make a grid: of all sizes and seeds the smallest network is kept
                           whose error on the held-out blocks is within 5 % of the lowest
  residual.horizons=[...]  samples the network runs free in training; [1]: one step ahead, as in the thesis
  residual.every=N         the network works on every n-th sample; residual.increment=true for slow errors
  residual.seeds=[...]     one network of each size for each, trained together
  residual.epochs=N, patience, batch, learning_rate, weight_decay, held_out, blocks, criterion, guard
Keys of residual=rbf
  residual.nodes=[...]     numbers of nodes to choose from
  residual.horizons=[...]  samples over which it is fitted (null: the whole record) to choose from
  residual.physics=refitted|fixed   whether the parameters are estimated with the network or kept
  residual.port=NAME       effort port; residual.over=velocity|position; residual.span=[from,to]
  residual.bounds.KEY=X    where the nodes may go; residual.folds=N, max_iterations, processes;
                           residual.judged=true: on those blocks though nothing is to be chosen
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

Its own keys
  sweep.stack=N            points that train together at most; 1: every point is a job of its own
  sweep.processes=N        side by side on this machine; default: one a core
  launcher=local|joblib|slurm   who does the jobs
  out=DIR                  the report and every point's run tree; default: outputs/sweeps/<name>-<digest>, and
                           each point where hybridid run would put it
"""

VALIDATE = """\
Runs the fitted model against every record and writes validate/metrics.json: MSE, RMSE, R2 and fit percentage
by record, output and view, and tests of the residual.

  hybridid validate case=emps validate.horizon=0.5

Its own keys
  validate.views=[...]     free_run: the whole record in one go; horizon: many short runs
  validate.horizon=S       length of each short run in s, each from an initial state of its own; default: 1.0
  validate.initial_state=estimated|measured   of the free run
  validate.records=[...]   roles or names; default: all
  validate.lags=N          lags in samples of the residual's correlations
"""

PLOT = """\
Draws record, model against data, error, friction over velocity, spectrum, residual correlation and the
spread of errors, as files for a paper.

  hybridid plot case=emps
  hybridid run case=emps plot.formats=[svg]    one kind of file: less than half the time

Its own keys
  plot.formats=[svg,pdf,png]   files of each figure; default: all three
"""

TRACE = """\
Adds every effect of the library at every port of its kind, refits all parameters together, and judges on
horizons that no fit has seen what the model lacks. Accepts an effect if its gain is significant, worth
having, determined by the records, and survives other ways to solve the equations; names together what the
records cannot tell apart; goes on until nothing passes. Writes trace/report.html, trace/trace.json and the
augmented model.

  hybridid trace case=emps
  hybridid trace case=emps effects=[viscous]                       with physics left out
  hybridid trace case=emps fit.records=[validation]                from one record alone
  hybridid trace case=emps trace.effects=[stribeck,dahl,lugre]     try only these
  hybridid trace --config-dir mylab case=mine trace.extra_effects=[mymodule:MY_EFFECT]
  hybridid run case=emps model=TREE/trace/model.json               go on with the augmented model

Its own keys
  trace.horizon=S          length of each horizon in s; default: auto, validate.horizon, or shorter where the
                           records would not give ten of them to judge by
  trace.records=[...]      roles or names of the records to fit; default: fit.records
  trace.held_out=[...]     of those that judge; null: alternate horizons of the fitted ones do;
                           default: auto, the validation records, or null if there are none
  trace.worth=X            smallest decrease of the held-out RMSE worth having; default: 0.05
  trace.alpha=X            probability of one false effect among all tried in a step; default: 0.01
  trace.tie=X              relative difference below which two effects are alike; default: 0.02
  trace.stands_in=X        share of what an effect and a learned effort beside it take from the squared error
                           that may be the latter's; above, the effect only stands in; default: 0.1
  trace.effects=[...]      ids to try; default: the whole library (hybridid effects)
  trace.extra_effects=[module:NAME,...]   effects of your own, tried beside them
  trace.ports=[...]        ports to try; default: all
  trace.most_effects=N     that may be accepted; default: 6
  trace.processes=N        side by side; default: one a core
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

Its own keys
  experiments=[NAME,...]   files of conf/experiment
  processes=N              experiments side by side; default: one a core
"""

FETCH = """\
Downloads the public records of a case to paths.data, checks their SHA-256 and resumes what was cut off.

  hybridid fetch emps
  hybridid fetch emps paths.data=/data/recordings

Its own keys
  archive.url=URL          a mirror of the archive
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

Its own keys
  tune.space.KEY={low: 1, high: 8, log: true}   vary a key, such as residual.width; or [a,b] to choose from
  tune.space.KEY=null      do not vary it
  tune.trials=N            in all, of every process, node and earlier command; default: 60
  tune.seconds=S           begin no trial after that time; default: no limit
  tune.processes=N         side by side on this machine; default: one a core
  tune.startup=N           random trials before the search adapts; default: 10
  tune.pruner=median|hyperband|none   which trials are ended early
  tune.seed=N              of the search
"""

LOG = """\
A run whose tracking server is down, slow or dies is complete, and kept in outputs/mlflow-waiting. This sends
every run that waits there to where it was to go, and says what it sent; whatever cuts it off, nothing is lost
or doubled. While something still waits, the exit code is 1.

  hybridid log
  hybridid log paths.outputs=/data/outputs
  hybridid log mlflow.tracking_uri=http://server:5000   all of them to this server

Its own keys
  mlflow.tracking_uri=URI  default: where each run was to go
"""

UI = """\
Opens MLflow's page on this machine alone (127.0.0.1): every run with its config, metrics, figures and files.

  hybridid ui
  hybridid ui port=8080 paths.outputs=/data/outputs

Its own keys
  port=N                   default: 5000
  mlflow.tracking_uri=URI  default: sqlite:///outputs/mlflow.db
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
    head = f"hybridid {name}: {summary}\n\n{details}"
    return f"{head}\n{_SHARED.format(name=name)}" if stages and name not in ("ui", "fetch", "log") else head
