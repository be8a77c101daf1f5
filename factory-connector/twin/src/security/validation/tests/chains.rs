//! Chains of authorities, and folders that change.

use std::time::Duration;

use super::*;

#[test]
fn a_revocation_outlasts_the_list_and_the_authority_by_which_it_is_known() {
    for (has_list, has_authority) in [(false, true), (true, false), (false, false)] {
        let fixture = Fixture::new(false);
        let (list, authority) = (&fixture.list, Authority::new("Plant CA"));
        let (client, other) = (authority.issue(7), authority.issue(8));
        fixture.trust(&client);
        fixture.trust(&other);
        list.add_issuer(&authority.certificate, "anna").unwrap();
        list.put_revocation_list(&authority.revoke(7, 2096), "anna").unwrap();
        assert_eq!(fixture.check(&client), Err(CertificateError::Revoked));
        let (authorities, lists) = (list.authorities().unwrap(), list.revocation_lists().unwrap());
        if !has_authority {
            assert!(list.remove_authority(&authorities[0].thumbprint, "anna").unwrap());
        }
        if !has_list {
            assert!(list.remove_revocation_list(&lists[0].id, "anna").unwrap());
        }
        let case = format!("list {has_list}, authority {has_authority}");
        assert_eq!(fixture.check(&client), Err(CertificateError::Denied), "{case}");
        assert_eq!(fixture.check(&other), Ok(()), "{case}");
        // Until an engineer trusts it again, and no list names it.
        assert!(list.trust(&thumbprint(&client), "anna").unwrap());
        let expected = if has_list { Err(CertificateError::Revoked) } else { Ok(()) };
        assert_eq!(fixture.check(&client), expected, "{case}");
    }
}

#[test]
fn an_authority_that_the_one_above_revoked_lets_nobody_in_once_that_list_is_gone() {
    let fixture = Fixture::new(false);
    let (root, list) = (Authority::new("Root CA"), &fixture.list);
    let plant = root.below("Plant CA", 9);
    let (client, single) = (plant.issue(1), plant.issue(2));
    list.add_issuer(&root.certificate, "anna").unwrap();
    list.trust_new(&plant.certificate, "anna").unwrap();
    list.put_revocation_list(&plant.revoke(8, 2096), "anna").unwrap();
    list.put_revocation_list(&root.revoke(9, 2096), "anna").unwrap();
    fixture.trust(&single);
    let lists = list.revocation_lists().unwrap();
    let of_root = lists.iter().find(|list| list.issuer.contains("Root CA")).unwrap();
    assert!(list.remove_revocation_list(&of_root.id, "anna").unwrap());
    assert_eq!(fixture.check(&client), Err(CertificateError::Unknown));
    assert_eq!(fixture.check(&single), Err(CertificateError::Denied));
}

#[test]
fn an_authority_that_is_denied_completes_no_chain() {
    let fixture = Fixture::new(false);
    let (root, list) = (Authority::new("Root CA"), &fixture.list);
    let plant = root.below("Plant CA", 9);
    let (client, single) = (plant.issue(1), plant.issue(2));
    list.trust_new(&root.certificate, "anna").unwrap();
    list.add_issuer(&plant.certificate, "anna").unwrap();
    for authority in [&root, &plant] {
        list.put_revocation_list(&authority.revoke(8, 2096), "anna").unwrap();
    }
    fixture.trust(&single);
    for certificate in [&client, &single] {
        assert_eq!(fixture.check(certificate), Ok(()));
    }
    let denied = fixture.folder.path().join("denied/plant.der");
    fs::write(&denied, &plant.certificate).unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    assert_eq!(fixture.check(&single), Ok(()), "the trust of one needs no authority");
    // Nor does what follows it in a file hide it.
    fs::write(&denied, [&plant.certificate[..], b"\n"].concat()).unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    // Not even one that is among the trusted ones, too.
    fs::write(fixture.folder.path().join("trusted/plant.der"), &plant.certificate).unwrap();
    assert_eq!(fixture.check(&client), Err(CertificateError::Denied));
    fs::remove_file(&denied).unwrap();
    assert_eq!(fixture.check(&client), Ok(()));
}

#[test]
fn many_connections_read_the_folders_once_and_a_change_counts_at_the_next_one() {
    // More than a tick of the system's clock.
    let soon = Duration::from_millis(40);
    let mut fixture = Fixture::new(false);
    let validator = &mut fixture.validator;
    for folder in [
        &mut validator.denied,
        &mut validator.trusted,
        &mut validator.issuers,
        &mut validator.lists,
    ] {
        folder.settle_after(soon);
    }
    let authority = Authority::new("Plant CA");
    let client = authority.issue(7);
    fixture.list.trust_new(&authority.certificate, "anna").unwrap();
    let path = |name: &str| fixture.folder.path().join(name);
    fs::write(path("crl/plant.crl"), authority.revoke(8, 2096)).unwrap();
    std::thread::sleep(2 * soon);
    assert_eq!(fixture.check(&client), Ok(()));
    let known = || fixture.validator.known.lock().clone().unwrap();
    let first = known();
    for _ in 0..200 {
        fixture.show(&self_signed());
        fixture.show(&client);
    }
    assert!(Arc::ptr_eq(&known(), &first), "nothing was read or verified again");

    // Each as soon as the one before is settled, so that it is the change itself that is seen.
    let (revoked, again) = (authority.revoke(7, 2096), authority.revoke(8, 2096));
    let der = client.as_byte_string();
    let changes: [(&str, &[u8], Result<(), CertificateError>); 4] = [
        ("crl/plant.crl", &revoked, Err(CertificateError::Revoked)),
        ("crl/plant.crl", b"damaged", Err(CertificateError::TrustListUnreadable)),
        ("crl/plant.crl", &again, Ok(())),
        ("denied/client.der", der.as_ref(), Err(CertificateError::Denied)),
    ];
    for (name, content, expected) in changes {
        fs::write(path(name), content).unwrap();
        assert_eq!(fixture.check(&client), expected, "{name}");
        std::thread::sleep(2 * soon);
        assert_eq!(fixture.check(&client), expected, "{name}");
    }
    fs::remove_file(path("denied/client.der")).unwrap();
    assert_eq!(fixture.check(&client), Ok(()));
}

#[test]
fn a_client_below_an_authority_that_the_one_above_revoked_is_refused() {
    let fixture = Fixture::new(false);
    let root = Authority::new("Root CA");
    let plant = root.below("Plant CA", 9);
    let (client, single) = (plant.issue(1), plant.issue(2));
    let list = &fixture.list;
    list.add_issuer(&root.certificate, "anna").unwrap();
    list.trust_new(&plant.certificate, "anna").unwrap();
    list.put_revocation_list(&plant.revoke(8, 2096), "anna").unwrap();
    fixture.trust(&single);
    for certificate in [&client, &single] {
        assert_eq!(fixture.check(certificate), Ok(()), "the root need not have a list");
    }
    list.put_revocation_list(&root.revoke(9, 2096), "anna").unwrap();
    for certificate in [&client, &single] {
        assert_eq!(fixture.check(certificate), Err(CertificateError::Revoked));
    }
}
