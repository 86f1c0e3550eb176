//! Models that pages edit: only the files that were given, only by pages that may, and never over
//! the change of another.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use monas_studio::{ModelLanguage, ModelWorkspace, Studio, StudioSettings};
use serde_json::{Value, json};

use crate::kit::{Viewer, address, exchange};

/// Counts words; a check of `slow` goes on until it is stopped.
struct Words;

impl ModelLanguage for Words {
    fn outline(&self, name: &str, text: &str) -> Value {
        json!({"done": true, "name": name, "words": text.split_whitespace().count()})
    }

    fn check(&self, _: &str, text: &str, stop: &Arc<AtomicBool>) -> Value {
        while text == "slow" && !stop.load(Ordering::SeqCst) {
            std::thread::yield_now();
        }
        json!({"done": true, "checked": text})
    }

    fn complete(&self, text: &str, expression: Option<&str>, at: usize) -> Value {
        json!({"done": true, "before": expression.unwrap_or(text)[..at]})
    }

    fn edit(&self, _: &str, edit: Value) -> Result<Value, String> {
        match edit["add"].as_str() {
            Some(word) => Ok(json!({"done": true, "edits": [{"from": 0, "to": 0, "insert": word}]})),
            None => Err("only words can be added".into()),
        }
    }
}

struct Models {
    folder: tempfile::TempDir,
    studio: Studio,
}

impl Models {
    fn serve(listen: &str, allows_control: bool) -> Models {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.srm", "b.srm", "secret.srm"] {
            fs::write(folder.path().join(name), "one two\n").unwrap();
        }
        let paths = ["a.srm", "b.srm"].map(|name| folder.path().join(name));
        let models = Some(Arc::new(ModelWorkspace::new(&paths, Arc::new(Words)).unwrap()));
        let listen = Some(listen.parse().unwrap());
        let settings = StudioSettings { listen, allows_control, models, ..StudioSettings::default() };
        Models { studio: Studio::of_models(settings).unwrap(), folder }
    }

    fn local() -> Models {
        Models::serve("127.0.0.1:0", false)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }
}

fn ask(viewer: &mut Viewer, mut request: Value) -> Value {
    request["id"] = json!(5);
    viewer.send(request);
    reply(viewer, 5)
}

fn reply(viewer: &mut Viewer, id: u64) -> Value {
    viewer.wait(|message| (message["type"] == "reply" && message["id"] == id).then(|| message.clone()))
}

#[test]
fn a_file_is_read_understood_and_saved() {
    let models = Models::local();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    let greeting = viewer.wait(|message| (message["type"] == "models").then(|| message.clone()));
    assert_eq!((&greeting["writable"], greeting["files"].as_array().map(Vec::len)), (&json!(true), Some(2)));
    let opened = ask(&mut viewer, json!({"type": "model open", "file": 0}));
    assert_eq!(opened["text"], "one two\n");
    let outline = ask(&mut viewer, json!({"type": "model outline", "file": 0, "text": "a b c"}));
    assert_eq!(outline["words"], 3);
    assert!(outline["name"].as_str().unwrap().ends_with("a.srm"));
    let completed = ask(&mut viewer, json!({"type": "model complete", "text": "abc", "at": 2}));
    assert_eq!(completed["before"], "ab");
    let edit = ask(&mut viewer, json!({"type": "model edit", "text": "", "edit": {"add": "zero "}}));
    assert_eq!(edit["edits"][0]["insert"], "zero ");
    let wrong = ask(&mut viewer, json!({"type": "model edit", "text": "", "edit": {}}));
    assert_eq!((&wrong["done"], &wrong["reason"]), (&json!(false), &json!("only words can be added")));
    let save =
        json!({"type": "model save", "file": 0, "text": "zero one two\n", "revision": opened["revision"]});
    let saved = ask(&mut viewer, save.clone());
    assert_eq!(saved["done"], true, "{saved}");
    assert_eq!(
        (models.text("a.srm").as_str(), models.text("b.srm").as_str()),
        ("zero one two\n", "one two\n")
    );
    // the revision is no longer the one of the file
    assert_eq!(ask(&mut viewer, save)["done"], false);
}

#[test]
fn a_file_that_another_has_changed_is_not_overwritten() {
    let models = Models::local();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    let opened = ask(&mut viewer, json!({"type": "model open", "file": 1}));
    fs::write(models.path("b.srm"), "theirs\n").unwrap();
    let save =
        |revision: &Value| json!({"type": "model save", "file": 1, "text": "mine\n", "revision": revision});
    let refused = ask(&mut viewer, save(&opened["revision"]));
    assert_eq!((&refused["done"], &refused["text"]), (&json!(false), &json!("theirs\n")));
    assert_eq!(models.text("b.srm"), "theirs\n");
    // knowing what is there, a page may replace it
    assert_eq!(ask(&mut viewer, save(&refused["revision"]))["done"], true);
    assert_eq!(models.text("b.srm"), "mine\n");
}

#[test]
fn a_deleted_file_is_written_again_only_by_a_page_that_knows_of_it() {
    let models = Models::local();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    let opened = ask(&mut viewer, json!({"type": "model open", "file": 1}));
    fs::remove_file(models.path("b.srm")).unwrap();
    let save =
        |revision: &Value| json!({"type": "model save", "file": 1, "text": "mine\n", "revision": revision});
    let refused = ask(&mut viewer, save(&opened["revision"]));
    assert_eq!((&refused["done"], &refused["text"]), (&json!(false), &Value::Null));
    assert!(!models.path("b.srm").exists());
    // another program has written it meanwhile
    fs::write(models.path("b.srm"), "theirs\n").unwrap();
    assert_eq!(ask(&mut viewer, save(&refused["revision"]))["text"], "theirs\n");
    fs::remove_file(models.path("b.srm")).unwrap();
    let unread = ask(&mut viewer, json!({"type": "model open", "file": 1}));
    assert!(unread["reason"].as_str().unwrap().ends_with("b.srm: the file was deleted"), "{unread}");
    assert_eq!(ask(&mut viewer, save(&refused["revision"]))["done"], true);
    assert_eq!(models.text("b.srm"), "mine\n");
}

#[test]
fn a_text_that_could_not_be_opened_again_is_not_saved() {
    let models = Models::local();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    let mut revision = ask(&mut viewer, json!({"type": "model open", "file": 0}))["revision"].clone();
    for (size, is_saved) in [(1 << 19, true), ((1 << 19) + 1, false)] {
        let save = json!({"type": "model save", "file": 0, "text": "x".repeat(size), "revision": revision});
        let saved = ask(&mut viewer, save);
        assert_eq!(saved["done"], is_saved, "{saved}");
        let opened = ask(&mut viewer, json!({"type": "model open", "file": 0}));
        assert_eq!(opened["text"].as_str().map(str::len), Some(1 << 19));
        revision = opened["revision"].clone();
    }
}

#[test]
fn no_other_file_is_read_or_written() {
    let models = Models::local();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    for request in [
        json!({"type": "model open", "file": 2}),
        json!({"type": "model open", "file": -1}),
        json!({"type": "model open", "file": "../secret.srm"}),
        json!({"type": "model open", "path": models.path("secret.srm")}),
        json!({"type": "model save", "file": 2, "text": "x", "revision": ""}),
        json!({"type": "model save", "file": 0, "path": models.path("secret.srm"), "text": "x", "revision": ""}),
        json!({"type": "model outline", "file": 7, "text": "x"}),
        json!({"type": "model check", "file": 7, "text": "x"}),
    ] {
        let reply = ask(&mut viewer, request.clone());
        assert_eq!(reply["done"], false, "{request}");
        assert!(reply.get("text").is_none());
    }
    assert_eq!(models.text("secret.srm"), "one two\n");
    let missing = ModelWorkspace::new(&[models.path("none.srm")], Arc::new(Words)).unwrap_err();
    assert!(missing.to_string().contains("none.srm"), "{missing}");
    let empty = tempfile::tempdir().unwrap();
    assert!(ModelWorkspace::new(&[empty.path().to_owned()], Arc::new(Words)).is_err());
}

#[cfg(unix)]
#[test]
fn a_link_is_followed_when_it_is_given_and_not_later() {
    let models = Models::local();
    let outside = models.path("outside.txt");
    fs::write(&outside, "one two\n").unwrap();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    let opened = ask(&mut viewer, json!({"type": "model open", "file": 0}));
    fs::remove_file(models.path("a.srm")).unwrap();
    std::os::unix::fs::symlink(&outside, models.path("a.srm")).unwrap();
    let save = json!({"type": "model save", "file": 0, "text": "x\n", "revision": opened["revision"]});
    let reply = ask(&mut viewer, save);
    assert_eq!(reply["done"], false);
    assert!(reply["reason"].as_str().unwrap().contains("replaced by a link"), "{reply}");
    assert_eq!(fs::read_to_string(&outside).unwrap(), "one two\n", "nothing is written over a link");
}

#[test]
fn a_newer_check_ends_the_one_that_goes_on() {
    let models = Models::local();
    let mut viewer = Viewer::open(&models.studio).unwrap();
    viewer.send(json!({"type": "model check", "id": 1, "file": 0, "text": "slow"}));
    // requests are answered meanwhile
    assert_eq!(ask(&mut viewer, json!({"type": "model open", "file": 0}))["done"], true);
    viewer.send(json!({"type": "model check", "id": 2, "file": 0, "text": "quick"}));
    let mut seen = Vec::new();
    viewer.wait(|message| {
        if message["type"] == "reply" {
            seen.push(message["id"].as_u64());
        }
        (seen.contains(&Some(1)) && seen.contains(&Some(2))).then_some(())
    });
}

#[test]
fn pages_of_others_cannot_write() {
    let upgrade = [
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
    ];
    let local = Models::local();
    let own = format!("Host: {}", address(&local.studio));
    for foreign in [&[own.as_str(), "Origin: http://evil.example"][..], &["Host: rebound.example"], &[]] {
        let reply = exchange(&local.studio, "GET /socket", &[foreign, &upgrade].concat());
        assert!(reply.starts_with("HTTP/1.1 403"), "{foreign:?}: {reply}");
    }
    for (allows_control, is_writable) in [(false, false), (true, true)] {
        let models = Models::serve("0.0.0.0:0", allows_control);
        let own = format!("Host: {}", address(&models.studio));
        let reply = exchange(&models.studio, "GET /socket", &[&[own.as_str()][..], &upgrade].concat());
        assert!(reply.starts_with("HTTP/1.1 403") && reply.contains("a token is needed"), "{reply}");
        let mut viewer = Viewer::open_with_token(&models.studio).unwrap();
        let greeting = viewer.wait(|message| (message["type"] == "models").then(|| message.clone()));
        assert_eq!(greeting["writable"], json!(is_writable));
        let opened = ask(&mut viewer, json!({"type": "model open", "file": 0}));
        let save = json!({"type": "model save", "file": 0, "text": "x\n", "revision": opened["revision"]});
        let saved = ask(&mut viewer, save);
        assert_eq!(saved["done"], json!(is_writable), "{saved}");
        assert_eq!(models.text("a.srm") == "x\n", is_writable);
    }
}

#[test]
fn a_studio_without_models_refuses_requests_about_them() {
    let folder = tempfile::tempdir().unwrap();
    let listen = Some("127.0.0.1:0".parse().unwrap());
    let settings = StudioSettings { listen, ..StudioSettings::default() };
    let studio = Studio::of_run(&folder.path().join("none.sock"), settings).unwrap();
    let mut viewer = Viewer::open(&studio).unwrap();
    let refused = ask(&mut viewer, json!({"type": "model open", "file": 0}));
    assert!(refused["done"] == false && refused["reason"].as_str().unwrap().contains("--edit"), "{refused}");
}
