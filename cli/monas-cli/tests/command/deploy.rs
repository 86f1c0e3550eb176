//! `monas deploy` to an ssh server on this computer, started by the test. If none is installed the
//! test prints that, and checks only what needs no server.

use std::fs;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;

use serde_json::Value;

use crate::copying::copy;
use crate::kit::{Answer, command, root};

/// A project's folder and an ssh server that accepts its keys; this computer is the robot.
struct Site {
    folder: tempfile::TempDir,
    server: Child,
    port: u16,
}

impl Drop for Site {
    fn drop(&mut self) {
        // Stops the deployed service, then the server.
        let _ = Command::new(self.there("service")).arg("stop").output();
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// This program, stripped once for all tests if `strip` is installed: most of its size is debug
/// information and symbols, which each release would copy and hash.
static PROGRAM: LazyLock<String> = LazyLock::new(|| {
    let (whole, small) = (env!("CARGO_BIN_EXE_monas"), concat!(env!("CARGO_TARGET_TMPDIR"), "/monas"));
    let strip = Command::new("strip").args(["-o", small, whole]).status();
    if strip.is_ok_and(|status| status.success()) { small } else { whole }.to_owned()
});

/// The first of these programs that exists.
fn installed(paths: &[&str]) -> Option<PathBuf> {
    paths.iter().map(PathBuf::from).find(|path| path.is_file())
}

fn write(path: &Path, text: &str) {
    fs::write(path, text).expect("the folder takes files");
}

fn script(path: &Path, text: &str) -> String {
    write(path, &format!("#!/bin/sh\n{text}\n"));
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("it is ours");
    path.display().to_string()
}

fn keys(path: &Path) {
    let made = Command::new("ssh-keygen").args(["-q", "-t", "ed25519", "-N", "", "-f"]).arg(path).status();
    assert!(made.expect("ssh-keygen comes with ssh").success());
}

impl Site {
    /// None if no ssh server is installed.
    #[expect(clippy::disallowed_methods, reason = "the output of the server must be read during the test")]
    fn open() -> Option<Site> {
        let sshd = installed(&["/usr/sbin/sshd", "/usr/local/sbin/sshd", "/usr/bin/sshd"]);
        let (Some(sshd), Some(_)) = (sshd, installed(&["/usr/bin/ssh", "/usr/local/bin/ssh"])) else {
            println!("no ssh server is installed: nothing is brought anywhere");
            return None;
        };
        // The server needs this folder if it runs as root.
        let _ = fs::create_dir_all("/run/sshd");
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        keys(&at("host"));
        keys(&at("mine"));
        let port =
            TcpListener::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a port").port();
        write(
            &at("sshd_config"),
            &format!(
                "Port {port}\nListenAddress 127.0.0.1\nHostKey {}\nAuthorizedKeysFile {}\nPidFile none\nUsePAM no\n\
                 StrictModes no\nPasswordAuthentication no\nPermitRootLogin prohibit-password\n\
                 SetEnv PATH={}:/usr/local/bin:/usr/bin:/bin XDG_CONFIG_HOME={}\n",
                at("host").display(),
                at("mine.pub").display(),
                at("tools").display(),
                at("units").display(),
            ),
        );
        let mut server = Command::new(sshd)
            .args(["-D", "-e", "-f"])
            .arg(at("sshd_config"))
            .stderr(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut said = BufReader::new(server.stderr.take().expect("it is piped"));
        let mut line = String::new();
        while !line.contains("Server listening") {
            line.clear();
            assert!(said.read_line(&mut line).expect("it says something") > 0, "the server has ended");
        }
        // The server keeps writing, so its output must be read.
        std::thread::spawn(move || std::io::copy(&mut said, &mut std::io::sink()));
        for part in ["config", "models"] {
            copy(&root().join(part), &at(part));
        }
        write(&at("known"), "");
        write(
            &at("ssh_config"),
            &format!(
                "UserKnownHostsFile {}\nStrictHostKeyChecking accept-new\nIdentitiesOnly yes\nLogLevel ERROR\nCiphers ^aes128-gcm@openssh.com\n",
                at("known").display()
            ),
        );
        let site = Site { folder, server, port };
        fs::create_dir(site.at("tools")).expect("the folder takes folders");
        site.describe("config/roles/goalie.xml", "ssh", "script");
        Some(site)
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A file on the robot.
    fn there(&self, name: &str) -> PathBuf {
        self.at("robot").join(name)
    }

    /// Writes the file of robots: one robot with a configuration, an ssh command and a kind of
    /// service.
    fn describe(&self, config: &str, ssh: &str, service: &str) {
        self.describe_with(config, ssh, service, "");
    }

    /// Likewise, with further attributes.
    fn describe_with(&self, config: &str, ssh: &str, service: &str, more: &str) {
        let user = Command::new("id").arg("-un").output().expect("a user").stdout;
        let user = String::from_utf8(user).expect("a name").trim().to_owned();
        let text = format!(
            "<robot name=\"nao-2\" address=\"{user}@127.0.0.1\" port=\"{}\" identity=\"{}\" ssh=\"{ssh} -F {}\" config=\"{config}\"\n  \
             folder=\"{}\" service=\"{service}\" settle=\"1s\" arguments=\"--no-control\" {more}/>\n",
            self.port,
            self.at("mine").display(),
            self.at("ssh_config").display(),
            self.at("robot").display(),
        );
        write(&self.at("robots.xml"), &text);
    }

    fn deploy(&self, arguments: &[&str]) -> Answer {
        let mut command = command(&[&["deploy", "nao-2"], arguments].concat());
        command.current_dir(self.folder.path()).output().expect("the command starts").into()
    }

    /// Deploys this program.
    fn bring(&self) -> Value {
        let answer = self.deploy(&["--program", &PROGRAM, "--format", "json"]);
        assert_eq!(answer.code, Some(0), "{answer:?}");
        serde_json::from_str(&answer.out).expect("JSON")
    }

    /// The robot's current release.
    fn current(&self) -> String {
        let target = fs::read_link(self.there("current")).expect("there is one");
        target.file_name().expect("a name").to_string_lossy().into_owned()
    }

    /// Whether the service runs on the robot.
    fn runs(&self) -> bool {
        Command::new(self.there("service")).arg("status").status().expect("there is one").success()
    }
}

#[test]
fn a_robot_gets_program_configuration_and_models_and_runs_them_and_what_fails_does_not_stay() {
    let Some(site) = Site::open() else { return };
    let first = site.bring();
    assert_eq!((&first["copied"], &first["before"]), (&Value::Bool(true), &Value::Null));
    let one = first["release"].as_str().expect("a name").to_owned();
    assert_eq!(site.current(), one);
    for file in ["start", "bin/monas", "config/roles/goalie.xml", "models/goalie.srm", "SHA256SUMS"] {
        assert!(site.there("current").join(file).is_file(), "{file}");
    }
    assert!(site.runs());
    let again = site.bring();
    assert_eq!(
        (&again["release"], &again["copied"]),
        (&first["release"], &Value::Bool(false)),
        "nothing is new"
    );

    let model = fs::read_to_string(site.at("models/goalie.srm")).expect("a model");
    write(&site.at("models/goalie.srm"), &format!("{model}# a remark\n"));
    let second = site.bring();
    assert_eq!(second["before"], one.as_str());
    let two = second["release"].as_str().expect("a name").to_owned();
    assert_eq!((site.current(), site.runs()), (two.clone(), true));

    // A program that prints its version and exits.
    let idle = script(&site.at("idle"), "echo it has nothing to do");
    let answer = site.deploy(&["--program", &idle]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(
        answer.err.contains("did not keep running for 1 s: the previous one runs again"),
        "{}",
        answer.err
    );
    assert!(answer.err.contains("it has nothing to do"), "{}", answer.err);
    assert_eq!((site.current(), site.runs()), (two.clone(), true));

    let broken = script(&site.at("broken"), "exit 126");
    let answer = site.deploy(&["--program", &broken]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.contains("does not start on the robot, and is not used"), "{}", answer.err);
    assert_eq!(site.current(), two);

    let back = site.deploy(&["--rollback"]);
    assert_eq!(back.code, Some(0), "{back:?}");
    assert_eq!((site.current(), site.runs()), (one.clone(), true));
    let listed = site.deploy(&["--list"]);
    assert!(listed.out.contains(&format!("{one}  current")), "{}", listed.out);
    assert!(listed.out.contains(&format!("{two}  previous")), "{}", listed.out);
}

#[test]
fn recordings_survive_a_crash_a_restart_and_a_new_release() {
    let Some(site) = Site::open() else { return };
    site.describe_with("config/roles/goalie.xml", "ssh", "script", "record=\"1\" keep=\"3\"");
    let recordings = || {
        let entries = fs::read_dir(site.there("recordings")).expect("a folder").flatten();
        let mut names: Vec<String> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort_unstable();
        names
    };
    let numbers = || recordings().iter().map(|name| name[..12].to_owned()).collect::<Vec<_>>();
    let size = |name: &str| fs::metadata(site.there("recordings").join(name)).expect("a file").len();
    site.bring();
    let first = recordings().pop().expect("a recording");
    let process = fs::read_to_string(site.there("service.pid")).expect("a number");
    let process = process.split(' ').next().expect("a number");
    assert!(Command::new("kill").args(["-9", process]).status().expect("there is a kill").success());
    while site.runs() {}
    let recorded = size(&first);
    assert!(recorded > 0);
    let start = || Command::new(site.there("service")).arg("start").status().expect("it is there").success();
    assert!(start());
    while numbers().len() < 2 {}
    let model = fs::read_to_string(site.at("models/goalie.srm")).expect("a model");
    write(&site.at("models/goalie.srm"), &format!("{model}# a remark\n"));
    site.bring();
    assert_eq!(numbers(), ["0001-goalie-", "0002-goalie-", "0003-goalie-"]);
    assert_eq!(size(&first), recorded, "the evidence of the crash is as it was");
    site.bring();
    assert_eq!(numbers(), ["0002-goalie-", "0003-goalie-", "0004-goalie-"], "the oldest is removed");
}

#[test]
fn a_robot_with_systemd_gets_a_unit_that_starts_the_current_release() {
    let Some(site) = Site::open() else { return };
    // Requests to systemctl are logged; the services of this computer are not touched.
    let log = site.at("systemctl.log");
    script(&site.at("tools/systemctl"), &format!("echo \"$@\" >>{}", log.display()));
    site.describe("config/roles/goalie.xml", "ssh", "auto");
    site.bring();
    let asked = fs::read_to_string(&log).expect("it was asked");
    let asked: Vec<&str> = asked.lines().collect();
    let begin = asked.iter().position(|line| *line == "--user daemon-reload").expect("the unit is read anew");
    let unit = asked[begin + 1].strip_prefix("--user enable ").expect("it starts with the robot");
    assert_eq!(asked[begin + 2], format!("--user restart {unit}"));
    assert_eq!(asked[begin + 3], format!("--user is-active --quiet {unit}"));
    let file = site.at("units/systemd/user").join(unit);
    let text = fs::read_to_string(&file).expect("a unit");
    let start = site.there("current/start");
    assert!(text.contains(&format!("ExecStart=\"{}\"\n", start.display())), "{text}");
    assert!(start.is_file());
    if let Some(analyze) = installed(&["/usr/bin/systemd-analyze"]) {
        let mut verify = Command::new(analyze);
        let verified =
            verify.args(["--user", "verify"]).arg(&file).env("XDG_RUNTIME_DIR", site.folder.path());
        let verified: Answer = verified.output().expect("it starts").into();
        assert_eq!((verified.code, verified.err.as_str()), (Some(0), ""), "{text}");
    }
}

#[test]
fn corrupt_files_are_rejected_and_unreachable_robots_are_reported() {
    let Some(site) = Site::open() else { return };
    // A transport that changes one word.
    let way = script(
        &site.at("way"),
        "case \"$*\" in *receive*) LC_ALL=C sed 's/Goalie/Goalee/' | ssh \"$@\" ;; *) ssh \"$@\" ;; esac",
    );
    site.describe("config/roles/goalie.xml", &way, "script");
    let answer = site.deploy(&["--program", "/bin/true"]);
    assert_eq!(answer.code, Some(1), "{answer:?}");
    assert!(answer.err.contains("the copy differs from the release and is not used"), "{}", answer.err);
    assert!(answer.err.contains("config/roles/goalie.xml: FAILED"), "{}", answer.err);
    assert!(!site.there("current").exists());
    let back = site.deploy(&["--rollback"]);
    assert!(back.err.contains("no release before the current one"), "{}", back.err);

    let unreachable = script(&site.at("unknown"), "echo 'no route to host' >&2; exit 255");
    site.describe("config/roles/goalie.xml", &unreachable, "script");
    let answer = site.deploy(&["--list"]);
    assert_eq!(answer.code, Some(4), "{answer:?}");
    assert!(
        answer.err.contains("nao-2 cannot be reached") && answer.err.contains("no route to host"),
        "{}",
        answer.err
    );
}

#[test]
fn errors_are_reported_before_the_copy() {
    let folder = tempfile::tempdir().expect("a folder");
    for part in ["config", "models"] {
        copy(&root().join(part), &folder.path().join(part));
    }
    let deploy = |robots: &str, arguments: &[&str]| -> Answer {
        write(&folder.path().join("robots.xml"), robots);
        let mut command = command(&[&["deploy", "nao-2", "--program", "/bin/true"], arguments].concat());
        command.current_dir(folder.path()).output().expect("the command starts").into()
    };
    let robot =
        |attributes: &str| format!("<robot name=\"nao-2\" config=\"config/roles/goalie.xml\" {attributes}/>");
    let answer = deploy(&robot("adress=\"nao@10.0.2.2\""), &[]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(
        answer.err.contains("robots.xml:1:54") && answer.err.contains("did you mean `address`?"),
        "{}",
        answer.err
    );
    let answer = deploy(&robot("address=\"-oProxyCommand=x\""), &[]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.err.contains("is not an address"), "{}", answer.err);
    let answer = deploy(&robot("address=\"nao@10.0.2.2\"").replace("nao-2", "nao-3"), &[]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.err.contains("did you mean `nao-3`?"), "{}", answer.err);
    let answer = deploy(&robot("address=\"nao@10.0.2.2\""), &["--dry-run"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert!(
        answer.out.contains("  bin/true\n") && answer.out.contains("  models/goalie.srm\n"),
        "{}",
        answer.out
    );
    let answer = deploy(&robot("address=\"nao@10.0.2.2\""), &["--dry-run", "--robots", "fleet.xml"]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(
        answer.err.contains("there is no file fleet.xml\n = help: write it: `<robot name=\"nao-2\""),
        "{}",
        answer.err
    );
    let goalie = folder.path().join("config/roles/goalie.xml");
    let plain = fs::read_to_string(&goalie).expect("a role");
    write(&goalie, &plain.replacen("<agent ", "<module>eyes.so</module>\n<agent ", 1));
    let answer = deploy(&robot("address=\"nao@10.0.2.2\""), &["--dry-run"]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    assert!(answer.err.contains("the module `eyes.so` would not be deployed"), "{}", answer.err);
    write(&goalie, &plain);
    let wrong = fs::read_to_string(&goalie).expect("a role").replace("goalie.srm", "goalee.srm");
    write(&goalie, &wrong);
    let answer = deploy(&robot("address=\"nao@10.0.2.2\""), &["--dry-run"]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
}
